// E57 (ASTM E2807): a file in pages with checksums, an XML section that describes the scans, and a
// section of packed points for each scan. Each scan has the pose of its scanner.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "e57_index.hpp"
#include "e57_pages.hpp"
#include "e57_streams.hpp"
#include "range_image.hpp"
#include "readers.hpp"
#include "scalar.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kHeaderBytes = 48;
constexpr std::uint64_t kMaxXmlBytes = std::uint64_t{1} << 26;

/// Roles of fields in addition to those of Slot.
enum Role : std::uint8_t {
  kRange = kSlots,
  kAzimuth,
  kElevation,
  kCartesianInvalid,
  kSphericalInvalid,
  kColourInvalid,
  kRoles
};

constexpr std::array<std::string_view, kRoles> kFieldNames = {"cartesianX",
                                                              "cartesianY",
                                                              "cartesianZ",
                                                              "normalX",
                                                              "normalY",
                                                              "normalZ",
                                                              "colorRed",
                                                              "colorGreen",
                                                              "colorBlue",
                                                              "sphericalRange",
                                                              "sphericalAzimuth",
                                                              "sphericalElevation",
                                                              "cartesianInvalidState",
                                                              "sphericalInvalidState",
                                                              "isColorInvalid"};

/// Index of the field for each role; -1: none.
using Columns = std::array<int, kRoles>;

Columns columns_of(const E57Scan& scan) {
  Columns columns;
  columns.fill(-1);
  for (std::size_t i = 0; i < scan.fields.size(); ++i) {
    const auto name = std::find(kFieldNames.begin(), kFieldNames.end(), scan.fields[i].name);
    if (name == kFieldNames.end() || scan.fields[i].type == E57Field::Type::kText) continue;
    columns[static_cast<std::size_t>(name - kFieldNames.begin())] = static_cast<int>(i);
  }
  return columns;
}

bool has(const Columns& columns, std::size_t first) {
  return columns[first] >= 0 && columns[first + 1] >= 0 && columns[first + 2] >= 0;
}

class E57Reader {
 public:
  E57Reader(InputFile& file, const ReadOptions& options)
      : file_(file), pages_(file), builder_(file.name(), options, "byte") {}

  Scan read(const std::filesystem::path& path) {
    std::vector<E57Scan> scans = parse_e57_index(file_.name(), read_xml(path));
    const std::size_t declared = scans.size();
    std::erase_if(scans, [](const E57Scan& scan) { return scan.count == 0; });
    if (scans.empty()) {
      throw ReadError(
          file_.name(), "",
          declared == 0
              ? "the file contains no points: it declares no scan"
              : fmt::format("the file contains no points: all scans ({}) are empty", declared),
          "check the export, and export it again");
    }
    choose_columns(scans);
    builder_.set_unit(1.0);
    for (const E57Scan& scan : scans) read_scan(scan);
    if (missing_ > 0) builder_.count_dropped("not_measured", missing_);
    if (builder_.points_read() == 0) {
      throw ReadError(file_.name(), "",
                      fmt::format("none of the {} points is valid, as the file states", missing_),
                      "export the scan again");
    }
    return builder_.finish("E57");
  }

 private:
  /// Opens the file separately, so that the progress of file_ rises with the points only.
  std::string read_xml(const std::filesystem::path& path) {
    InputFile file(path, nullptr, file_.name());
    E57Pages pages(file);
    std::array<char, kHeaderBytes> header{};
    pages.read(header.data(), header.size());
    const auto word = [&](std::size_t at) {
      return load_bits<std::uint64_t, false>(header.data() + at);
    };
    const auto version = load_bits<std::uint32_t, false>(header.data() + 8);
    if (version != 1) {
      fail_header(fmt::format("version {} of the format is not supported", version),
                  "export the scan as E57 1.0 or as PLY");
    }
    if (word(40) != E57Pages::kPageBytes) {
      fail_header(fmt::format("pages of {} bytes are not supported", word(40)),
                  "export the scan again, or as PLY");
    }
    if (word(16) > file_.size()) {
      fail_header(fmt::format("the file ends too early: {} bytes are declared, {} are present",
                              word(16), file_.size()),
                  kCopyAgain);
    }
    const std::uint64_t begin = pages.to_logical(word(24), "the descriptions of the scans");
    const std::uint64_t bytes = word(32);
    if (bytes > pages.size() - begin || bytes > kMaxXmlBytes) {
      fail_header(fmt::format("its XML section of {} bytes is too large for the file", bytes),
                  kCopyAgain);
    }
    builder_.charge(bytes);
    std::string xml(static_cast<std::size_t>(bytes), '\0');
    pages.seek(begin);
    pages.read(xml.data(), xml.size());
    constexpr std::uint64_t kBytesPerTag = 200;  // parsed, with its attributes
    builder_.charge(kBytesPerTag *
                    static_cast<std::uint64_t>(std::count(xml.begin(), xml.end(), '<')));
    return xml;
  }

  /// Normals and colours are used only if all scans have them.
  void choose_columns(const std::vector<E57Scan>& scans) {
    std::size_t normals = 0;
    std::size_t colours = 0;
    for (const E57Scan& scan : scans) {
      const Columns columns = columns_of(scan);
      normals += has(columns, kNx) ? 1U : 0U;
      colours += has(columns, kRed) ? 1U : 0U;
    }
    has_normals_ = normals == scans.size();
    has_colours_ = colours == scans.size();
    if (has_normals_) builder_.use_normals();
    if (has_colours_) builder_.use_colours(ColourRange::kByte);
    builder_.thin_large_cloud();
    const auto warn = [&](std::size_t count, const char* what) {
      if (count > 0 && count < scans.size()) {
        builder_.warn(fmt::format("Only {} of {} scans have {}, which were therefore ignored.",
                                  count, scans.size(), what));
      }
    };
    warn(normals, "normals");
    warn(colours, "colours");
  }

  void read_scan(const E57Scan& scan) {
    columns_ = columns_of(scan);
    spherical_ = !has(columns_, kX);
    if (spherical_ && !has(columns_, kRange)) {
      throw ReadError(file_.name(), scan.place,
                      "its points have neither cartesian nor spherical coordinates",
                      "export the scan again with its coordinates");
    }
    E57Streams streams(pages_, scan, file_.name());
    builder_.expect_points(builder_.points_kept() + scan.count);
    begin_pose(scan);
    begin_colours(scan);
    streams.read([&](const std::vector<double>& values) { add_point(scan, values); });
  }

  /// A scan without a pose may have been recorded by several scanners, so its pose stays unknown.
  void begin_pose(const E57Scan& scan) {
    const std::optional<Eigen::Vector3d> stated =
        scan.has_pose ? std::optional<Eigen::Vector3d>(scan.to_file.translation()) : std::nullopt;
    builder_.begin_pose();
    if (const std::optional<ScannerPose> pose = RangeImage(0, stated).pose()) {
      builder_.set_pose(pose->position, pose->sure);
    }
  }

  [[nodiscard]] double value(const std::vector<double>& values, std::size_t role) const {
    return columns_[role] < 0 ? 0.0 : values[static_cast<std::size_t>(columns_[role])];
  }

  void add_point(const E57Scan& scan, const std::vector<double>& values) {
    if (value(values, spherical_ ? kSphericalInvalid : kCartesianInvalid) != 0.0) {
      ++missing_;
      return;
    }
    PointRow row{};
    const Eigen::Vector3d at = scan.to_file * position(values);
    std::copy_n(at.data(), 3, row.begin() + kX);
    if (has_normals_) {
      const Eigen::Vector3d normal =
          scan.to_file.linear() *
          Eigen::Vector3d(value(values, kNx), value(values, kNy), value(values, kNz));
      std::copy_n(normal.data(), 3, row.begin() + kNx);
    }
    if (has_colours_ && value(values, kColourInvalid) == 0.0) set_colour(values, row);
    builder_.add_point(row);
  }

  [[nodiscard]] Eigen::Vector3d position(const std::vector<double>& values) const {
    if (!spherical_) return {value(values, kX), value(values, kY), value(values, kZ)};
    const double range = value(values, kRange);
    const double azimuth = value(values, kAzimuth);
    const double elevation = value(values, kElevation);
    const double level = range * std::cos(elevation);
    return {level * std::cos(azimuth), level * std::sin(azimuth), range * std::sin(elevation)};
  }

  /// Limits of a colour that the scan states; none if they are those of a usual range, which some
  /// programs state though the colours have another one.
  [[nodiscard]] std::optional<std::array<double, 2>> colour_limits(const E57Scan& scan,
                                                                   std::size_t k) const {
    constexpr double kMost = 65535.0;
    const E57Field& field = scan.fields[static_cast<std::size_t>(columns_[kRed + k])];
    auto [lowest, highest] = scan.colour_limits[k];
    if (!(highest > lowest)) {
      lowest = field.lowest;
      highest = field.highest;
    }
    const bool usual = lowest == 0.0 && (highest == 1.0 || highest == 255.0 || highest == kMost);
    if (usual || !(highest > lowest) || lowest < -kMost || highest > kMost) return std::nullopt;
    return std::array<double, 2>{lowest, highest};
  }

  /// Without limits, the largest value of the scan decides.
  void begin_colours(const E57Scan& scan) {
    if (!has_colours_) return;
    ColourRange range = ColourRange::kByte;
    for (std::size_t k = 0; k < 3; ++k) {
      limits_[k] = colour_limits(scan, k);
      if (limits_[k]) continue;
      const E57Field& field = scan.fields[static_cast<std::size_t>(columns_[kRed + k])];
      range =
          field.type == E57Field::Type::kInteger ? ColourRange::kWordOrByte : ColourRange::kAuto;
    }
    if (range != ColourRange::kByte) limits_ = {};
    builder_.begin_colours(range);
  }

  void set_colour(const std::vector<double>& values, PointRow& row) const {
    for (std::size_t k = 0; k < 3; ++k) {
      double channel = value(values, kRed + k);
      if (limits_[k]) {
        const auto [lowest, highest] = *limits_[k];
        channel = 255.0 * (channel - lowest) / (highest - lowest);
      }
      row[kRed + k] = channel;
    }
  }

  [[noreturn]] void fail_header(const std::string& cause, const char* remedy) const {
    throw ReadError(file_.name(), "header", cause, remedy);
  }

  InputFile& file_;
  E57Pages pages_;
  ScanBuilder builder_;
  Columns columns_{};                                           // of the current scan
  std::array<std::optional<std::array<double, 2>>, 3> limits_;  // of its colours
  bool spherical_ = false;
  bool has_normals_ = false;
  bool has_colours_ = false;
  std::uint64_t missing_ = 0;
};

}  // namespace

Scan read_e57(InputFile& file, const std::filesystem::path& path, const ReadOptions& options) {
  return E57Reader(file, options).read(path);
}

}  // namespace tactree::builder
