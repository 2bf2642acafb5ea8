#include "e57_index.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh_import/xml_document.hpp"
#include "number.hpp"
#include "readers.hpp"

namespace tactree::builder {
namespace {

constexpr const char* kExportE57Again = "export the scan again, or convert it to PLY";

// Limits of the XML section. A scan takes about 50 tags.
constexpr XmlLimits kXmlLimits{std::size_t{1} << 26, 1'000'000};

/// Reads the elements that describe the points: e57Root / data3D / scan / ...
class IndexParser {
 public:
  explicit IndexParser(const std::string& file) : file_(file) {}

  std::vector<E57Scan> parse(std::string xml) {
    try {
      const XmlDocument document(std::move(xml), kXmlLimits);
      read_root(child_of(document.root(), "e57Root"));
    } catch (const XmlError& error) {
      fail_section(error.what());
    }
    return std::move(scans_);
  }

 private:
  void read_root(pugi::xml_node root) {
    if (root.empty()) fail_section("it has no element \"e57Root\"");
    for_children(root, "data3D", [&](pugi::xml_node list) {
      for (const pugi::xml_node scan : list.children()) {
        if (scan.type() == pugi::node_element) read_scan(scan);
      }
    });
  }

  void read_scan(pugi::xml_node element) {
    place_ = fmt::format("scan {}", scans_.size() + 1);
    E57Scan& scan = scans_.emplace_back();
    scan.place = place_;
    if (const pugi::xml_node points = child_of(element, "points"); !points.empty()) {
      scan.count = whole<std::uint64_t>(points, "recordCount", 0);
      scan.offset = whole<std::uint64_t>(points, "fileOffset", 0);
      for (const pugi::xml_node field : child_of(points, "prototype").children()) {
        if (field.type() == pugi::node_element) scan.fields.push_back(read_field(field));
      }
    }
    read_colour_limits(child_of(element, "colorLimits"), scan);
    if (const pugi::xml_node pose = child_of(element, "pose"); !pose.empty()) {
      scan.has_pose = true;
      set_pose(pose, scan.to_file);
    }
  }

  void read_colour_limits(pugi::xml_node limits, E57Scan& scan) const {
    constexpr std::array<const char*, 3> kColours = {"colorRed", "colorGreen", "colorBlue"};
    for (std::size_t k = 0; k < kColours.size(); ++k) {
      const std::string colour = kColours[k];
      scan.colour_limits[k] = {content(child_of(limits, colour + "Minimum")),
                               content(child_of(limits, colour + "Maximum"))};
    }
  }

  void set_pose(pugi::xml_node element, Eigen::Affine3d& pose) const {
    if (const pugi::xml_node turn = child_of(element, "rotation"); !turn.empty()) {
      const Eigen::Quaterniond rotation(content(child_of(turn, "w")), content(child_of(turn, "x")),
                                        content(child_of(turn, "y")), content(child_of(turn, "z")));
      const double norm = rotation.norm();
      if (!(norm > 0.0) || !std::isfinite(norm))
        fail("the rotation of its pose is not a quaternion");
      pose.linear() = rotation.normalized().toRotationMatrix();
    }
    const pugi::xml_node shift = child_of(element, "translation");
    pose.translation() =
        Eigen::Vector3d(content(child_of(shift, "x")), content(child_of(shift, "y")),
                        content(child_of(shift, "z")));
    if (!pose.matrix().allFinite()) fail("the translation of its pose is not finite");
  }

  E57Field read_field(pugi::xml_node element) const {
    E57Field field;
    field.name = local_name(element);
    const std::string_view type = attribute_of(element, "type");
    if (type == "Float") {
      const bool single = attribute_of(element, "precision") == "single";
      field.type = single ? E57Field::Type::kSingle : E57Field::Type::kDouble;
      field.bits = single ? 32 : 64;
      field.lowest = real(element, "minimum", 0.0);
      field.highest = real(element, "maximum", 0.0);
    } else if (type == "Integer" || type == "ScaledInteger") {
      read_integer(element, type == "ScaledInteger", field);
    } else if (type == "String") {
      field.type = E57Field::Type::kText;
    } else {
      fail(
          fmt::format("the field \"{}\" of its points has the type \"{}\", which is not "
                      "supported",
                      printable(local_name(element)), printable(type)));
    }
    return field;
  }

  void read_integer(pugi::xml_node element, bool scaled, E57Field& field) const {
    using Limits = std::numeric_limits<std::int64_t>;
    field.type = E57Field::Type::kInteger;
    field.minimum = whole<std::int64_t>(element, "minimum", Limits::min());
    const auto maximum = whole<std::int64_t>(element, "maximum", Limits::max());
    if (maximum < field.minimum) {
      fail(fmt::format("the maximum of \"{}\" is below its minimum",
                       printable(local_name(element))));
    }
    const auto range =
        static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(field.minimum);
    field.bits = static_cast<unsigned>(std::bit_width(range));
    if (scaled) {
      field.scale = real(element, "scale", 1.0);
      field.offset = real(element, "offset", 0.0);
    }
    if (!attribute_of(element, "minimum").empty() && !attribute_of(element, "maximum").empty()) {
      field.lowest = field.offset + field.scale * static_cast<double>(field.minimum);
      field.highest = field.offset + field.scale * static_cast<double>(maximum);
    }
  }

  /// Returns the number in an element, or 0 if there is none, as the standard defines.
  [[nodiscard]] double content(pugi::xml_node element) const {
    const std::string_view text = trim_lines(element.child_value());
    double value = 0.0;
    if (!text.empty() && !parse_number(text, value)) {
      fail(fmt::format("\"{}\" in {} is not a number", printable(text), local_name(element)));
    }
    return value;
  }

  static std::string_view trim_lines(std::string_view text) {
    constexpr std::string_view kSpaces = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(kSpaces);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kSpaces) - begin + 1);
  }

  double real(pugi::xml_node element, const char* attribute, double missing) const {
    const std::string_view text = trim(attribute_of(element, attribute));
    double value = missing;
    if (!text.empty() && (!parse_number(text, value) || !std::isfinite(value))) {
      fail_attribute(element, attribute, text);
    }
    return value;
  }

  template <typename Integer>
  Integer whole(pugi::xml_node element, const char* attribute, Integer missing) const {
    const std::string_view text = trim(attribute_of(element, attribute));
    std::int64_t value = 0;
    if (text.empty()) return missing;
    if (!parse_integer(text, value) || (std::is_unsigned_v<Integer> && value < 0)) {
      fail_attribute(element, attribute, text);
    }
    return static_cast<Integer>(value);
  }

  [[noreturn]] void fail_attribute(pugi::xml_node element, const char* attribute,
                                   std::string_view text) const {
    fail(fmt::format("the {} of \"{}\" has the invalid value \"{}\"", attribute,
                     printable(local_name(element)), printable(text)));
  }
  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_, place_, cause, kExportE57Again);
  }
  [[noreturn]] void fail_section(const std::string& cause) const {
    throw ReadError(file_, "XML section", cause, kCopyAgain);
  }

  const std::string& file_;
  std::vector<E57Scan> scans_;
  std::string place_;  // of the last scan, for messages
};

}  // namespace

std::vector<E57Scan> parse_e57_index(const std::string& file, std::string xml) {
  return IndexParser(file).parse(std::move(xml));
}

}  // namespace tactree::builder
