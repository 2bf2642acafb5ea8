#include "e57_index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "mesh_import/xml_tags.hpp"
#include "number.hpp"
#include "readers.hpp"

namespace tactree::builder {
namespace {

constexpr const char* kExportE57Again = "export the scan again, or convert it to PLY";

/// Reads the elements that describe the points, by their path from the root.
class IndexParser {
 public:
  explicit IndexParser(const std::string& file) : file_(file) {}

  std::vector<E57Scan> parse(std::string_view xml) {
    XmlTags tags(xml);
    tags_ = &tags;
    while (tags.next()) {
      if (tags.closes()) {
        close();
        continue;
      }
      path_.emplace_back(tags.name());
      open();
      if (tags.is_empty()) path_.pop_back();
    }
    if (tags.cut_off() || !path_.empty()) fail_section("it ends inside an element");
    if (!found_) fail_section("it has no element \"e57Root\"");
    return std::move(scans_);
  }

 private:
  /// Names of the path from the element of a scan on: e57Root / data3D / scan / ...
  [[nodiscard]] bool is_at(std::initializer_list<std::string_view> names) const {
    constexpr std::size_t kScanDepth = 3;
    return path_.size() == kScanDepth + names.size() && path_[0] == "e57Root" &&
           path_[1] == "data3D" && std::equal(names.begin(), names.end(), path_.begin() + 3);
  }

  void open() {
    found_ = found_ || (path_.size() == 1 && path_[0] == "e57Root");
    if (is_at({})) {
      place_ = fmt::format("scan {}", scans_.size() + 1);
      scans_.emplace_back().place = place_;
      turn_ = {0.0, 0.0, 0.0, 0.0};
      shift_.setZero();
      has_turn_ = false;
    } else if (is_at({"points"})) {
      scans_.back().count = whole<std::uint64_t>("recordCount", 0);
      scans_.back().offset = whole<std::uint64_t>("fileOffset", 0);
    } else if (is_at({"points", "prototype", tags_->name()})) {
      scans_.back().fields.push_back(read_field());
    } else if (is_at({"pose"})) {
      scans_.back().has_pose = true;
    } else if (is_at({"pose", "rotation"})) {
      has_turn_ = true;
    }
  }

  void close() {
    if (path_.empty() || path_.back() != tags_->name()) {
      fail_section(fmt::format("byte {} of the section: the end of \"{}\" has no begin",
                               tags_->offset(), printable(tags_->name())));
    }
    read_content();
    if (is_at({"pose"})) set_pose();
    path_.pop_back();
  }

  /// The number in an element that ends here; 0 without one, as the standard defines.
  void read_content() {
    constexpr std::array<std::string_view, 4> kTurn = {"w", "x", "y", "z"};
    constexpr std::array<const char*, 3> kColours = {"colorRed", "colorGreen", "colorBlue"};
    const std::string_view name = path_.back();
    for (std::size_t k = 0; k < kTurn.size(); ++k) {
      if (name != kTurn[k]) continue;
      if (is_at({"pose", "rotation", name})) turn_[k] = content();
      if (k > 0 && is_at({"pose", "translation", name})) {
        shift_[static_cast<Eigen::Index>(k - 1)] = content();
      }
    }
    if (!is_at({"colorLimits", name})) return;
    for (std::size_t k = 0; k < kColours.size(); ++k) {
      std::array<double, 2>& limits = scans_.back().colour_limits[k];
      if (name == std::string(kColours[k]) + "Minimum") limits[0] = content();
      if (name == std::string(kColours[k]) + "Maximum") limits[1] = content();
    }
  }

  void set_pose() {
    Eigen::Affine3d& pose = scans_.back().to_file;
    if (has_turn_) {
      const Eigen::Quaterniond rotation(turn_[0], turn_[1], turn_[2], turn_[3]);
      const double norm = rotation.norm();
      if (!(norm > 0.0) || !std::isfinite(norm)) fail("the rotation of its pose is no quaternion");
      pose.linear() = rotation.normalized().toRotationMatrix();
    }
    pose.translation() = shift_;
    if (!pose.matrix().allFinite()) fail("the translation of its pose is not finite");
  }

  E57Field read_field() const {
    E57Field field;
    field.name = tags_->name();
    const std::string_view type = tags_->attribute("type");
    if (type == "Float") {
      const bool single = tags_->attribute("precision") == "single";
      field.type = single ? E57Field::Type::kSingle : E57Field::Type::kDouble;
      field.bits = single ? 32 : 64;
      field.lowest = real("minimum", 0.0);
      field.highest = real("maximum", 0.0);
    } else if (type == "Integer" || type == "ScaledInteger") {
      read_integer(type == "ScaledInteger", field);
    } else if (type == "String") {
      field.type = E57Field::Type::kText;
    } else {
      fail(
          fmt::format("the field \"{}\" of its points has the type \"{}\", which is not "
                      "supported",
                      printable(tags_->name()), printable(type)));
    }
    return field;
  }

  void read_integer(bool scaled, E57Field& field) const {
    using Limits = std::numeric_limits<std::int64_t>;
    field.type = E57Field::Type::kInteger;
    field.minimum = whole<std::int64_t>("minimum", Limits::min());
    const auto maximum = whole<std::int64_t>("maximum", Limits::max());
    if (maximum < field.minimum) {
      fail(fmt::format("the maximum of \"{}\" is below its minimum", printable(tags_->name())));
    }
    const auto range =
        static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(field.minimum);
    field.bits = static_cast<unsigned>(std::bit_width(range));
    if (scaled) {
      field.scale = real("scale", 1.0);
      field.offset = real("offset", 0.0);
    }
    if (!tags_->attribute("minimum").empty() && !tags_->attribute("maximum").empty()) {
      field.lowest = field.offset + field.scale * static_cast<double>(field.minimum);
      field.highest = field.offset + field.scale * static_cast<double>(maximum);
    }
  }

  [[nodiscard]] double content() const {
    const std::string_view text = trim_lines(tags_->text_before());
    double value = 0.0;
    if (!text.empty() && !parse_number(text, value)) {
      fail(fmt::format("\"{}\" in {} is not a number", printable(text), path_.back()));
    }
    return value;
  }

  static std::string_view trim_lines(std::string_view text) {
    constexpr std::string_view kSpaces = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(kSpaces);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kSpaces) - begin + 1);
  }

  double real(const char* attribute, double missing) const {
    const std::string_view text = trim(tags_->attribute(attribute));
    double value = missing;
    if (!text.empty() && (!parse_number(text, value) || !std::isfinite(value))) {
      fail_attribute(attribute, text);
    }
    return value;
  }

  template <typename Integer>
  Integer whole(const char* attribute, Integer missing) const {
    const std::string_view text = trim(tags_->attribute(attribute));
    std::int64_t value = 0;
    if (text.empty()) return missing;
    if (!parse_integer(text, value) || (std::is_unsigned_v<Integer> && value < 0)) {
      fail_attribute(attribute, text);
    }
    return static_cast<Integer>(value);
  }

  [[noreturn]] void fail_attribute(const char* attribute, std::string_view text) const {
    fail(fmt::format("the {} of \"{}\" is \"{}\"", attribute, printable(tags_->name()),
                     printable(text)));
  }
  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_, place_, cause, kExportE57Again);
  }
  [[noreturn]] void fail_section(const std::string& cause) const {
    throw ReadError(file_, "XML section", cause, kCopyAgain);
  }

  const std::string& file_;
  const XmlTags* tags_ = nullptr;
  std::vector<std::string_view> path_;  // of the open elements
  bool found_ = false;
  std::vector<E57Scan> scans_;
  std::string place_;  // of the last of them
  bool has_turn_ = false;
  std::array<double, 4> turn_{};  // quaternion w x y z
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<E57Scan> parse_e57_index(const std::string& file, std::string_view xml) {
  return IndexParser(file).parse(xml);
}

}  // namespace tactree::builder
