// LAS 1.0 to 1.4: a header, records about the file, and a record of integers for each point.

#include <fmt/format.h>

#include <algorithm>

#include "las_header.hpp"
#include "readers.hpp"
#include "scalar.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kLasBlockBytes = std::size_t{1} << 20;

class LasReader {
 public:
  LasReader(InputFile& file, const std::filesystem::path& path, const ReadOptions& options)
      : file_(file),
        header_(read_las_header(file, path)),
        builder_(file.name(), options, "byte"),
        box_(header_.box, header_.scale) {}

  Scan read() {
    if (header_.points == 0) {
      throw ReadError(file_.name(), "header",
                      "the file contains no points: its header declares 0 points",
                      "check the export, and export it again");
    }
    set_units();
    read_records();
    builder_.count_dropped("withheld", withheld_);
    drop_noise();
    check_box();
    return builder_.finish(
        fmt::format("LAS 1.{} point format {}", header_.minor, header_.point_format));
  }

 private:
  void set_units() {
    const LasUnits& units = header_.units;
    if (units.degrees) {
      builder_.warn(
          "The file states longitude and latitude in degrees; the surface is distorted (project it "
          "first, for example with pdal translate and filters.reprojection).");
    }
    if (units.horizontal) builder_.set_unit(*units.horizontal);
    if (units.horizontal && units.vertical) to_horizontal_ = *units.vertical / *units.horizontal;
    warn_of_unknown_units();
  }

  void warn_of_unknown_units() {
    const LasUnits& units = header_.units;
    const std::string& file = file_.name();
    if (!units.unknown.empty()) {
      builder_.warn(fmt::format(
          "{}: the unit is not known: the header states {}; all coordinates were taken as metres "
          "unless --unit states their unit",
          file, units.unknown));
    } else if (!units.horizontal && !units.degrees && units.vertical.value_or(1.0) != 1.0) {
      builder_.warn(fmt::format(
          "{}: the header states heights in units of {} m, but no unit of x and y; all coordinates "
          "were taken as metres unless --unit states their unit",
          file, *units.vertical));
    }
    if (!units.unknown_height.empty()) {
      builder_.warn(fmt::format(
          "{}: the unit of the heights is not known: the header states {}; they were taken to have "
          "the unit of x and y (if the model is too high or too flat, export the scan with heights "
          "in this unit)",
          file, units.unknown_height));
    }
    if (units.differ) {
      builder_.warn(fmt::format(
          "{}: its GeoTIFF keys and its well-known text state different units; the header says "
          "which are valid (check the size, --unit states another unit)",
          file));
    }
  }

  void drop_noise() {
    builder_.count_dropped("noise", noise_);
    if (builder_.points_read() == 0) {
      throw ReadError(
          file_.name(), "",
          noise_ == 0
              ? fmt::format("all {} points are marked as withheld", header_.points)
              : fmt::format("all {} points are marked as withheld or noise", header_.points),
          "remove the marks if the points are to be used");
    }
    if (noise_ == 0) return;
    builder_.note(
        fmt::format("{}: {} of {} points that the file classifies as noise were dropped (give them "
                    "another class to keep them)",
                    file_.name(), noise_, header_.points));
  }

  void check_box() {
    const std::string message = box_.message();
    if (message.empty()) return;
    if (box_.are_damaged()) {
      throw ReadError(file_.name(), "", message,
                      "the file is damaged, for example by a transfer as text; copy it again");
    }
    builder_.warn(fmt::format(
        "{}: {} (check the size; the file is damaged, or its header was not brought up to date)",
        file_.name(), message));
  }

  void read_records() {
    const std::uint64_t bytes = header_.record_bytes;
    file_.skip(header_.first_point - file_.offset());
    const std::uint64_t there = file_.remaining() / bytes;
    if (there < header_.points) fail_truncated(there);
    if (header_.layout.colour >= 0) builder_.use_colours(ColourRange::kWordOrByte);
    builder_.thin_large_cloud();
    builder_.reserve_points(header_.points);
    for (std::uint64_t left = header_.points; left > 0;) {
      const std::string_view block = file_.peek(kLasBlockBytes);
      const std::uint64_t points = std::min<std::uint64_t>(left, block.size() / bytes);
      if (points == 0) fail_truncated(header_.points - left);
      const char* at = block.data();
      for (std::uint64_t i = 0; i < points; ++i, at += bytes) add_record(at, header_.layout);
      file_.consume(static_cast<std::size_t>(points * bytes));
      left -= points;
    }
    // From 1.3 on, other records may follow the points.
    const bool last = header_.minor < 3 && there > header_.points;
    if (last && !file_.only_zeros_left()) builder_.warn_of_more("points", header_.points, there);
  }

  /// In version 1.0, all bits of the flags belong to a class of the user's own.
  bool is_dropped(const char* record, const LasLayout& layout) {
    if (header_.minor == 0) return false;
    const auto flags = static_cast<unsigned char>(record[15]);
    const unsigned withheld = layout.extended ? 0x04 : 0x80;
    if ((flags & withheld) != 0) {
      ++withheld_;
      return true;
    }
    constexpr unsigned kLowNoise = 7;
    constexpr unsigned kHighNoise = 18;  // only where a class has eight bits
    const unsigned kind = layout.extended ? static_cast<unsigned char>(record[16]) : flags & 0x1fU;
    const bool noise = kind == kLowNoise || (layout.extended && kind == kHighNoise);
    noise_ += noise ? 1U : 0U;
    return noise;
  }

  void add_record(const char* record, const LasLayout& layout) {
    if (is_dropped(record, layout)) return;
    PointRow row{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const double number = load_scalar<false>(record + 4 * k, ScalarType::kInt32);
      row[kX + k] = number * header_.scale[axis] + header_.offset[axis];
    }
    box_.add({row[kX], row[kY], row[kZ]});
    row[kZ] *= to_horizontal_;
    if (layout.colour >= 0) {
      for (std::size_t k = 0; k < 3; ++k) {
        row[kRed + k] = load_scalar<false>(record + layout.colour + 2 * k, ScalarType::kUint16);
      }
    }
    builder_.add_point(row);
  }

  [[noreturn]] void fail_truncated(std::uint64_t points_there) const {
    throw ReadError(
        file_.name(), fmt::format("byte {}", file_.size()),
        fmt::format("the file ends too early: its header declares {} points, only {} are present",
                    header_.points, points_there),
        kCopyAgain);
  }

  InputFile& file_;
  LasHeader header_;
  ScanBuilder builder_;
  LasBoxCheck box_;
  double to_horizontal_ = 1.0;  // unit of z / unit of x and y
  std::uint64_t withheld_ = 0;
  std::uint64_t noise_ = 0;
};

}  // namespace

Scan read_las(InputFile& file, const std::filesystem::path& path, const ReadOptions& options) {
  return LasReader(file, path, options).read();
}

}  // namespace tactree::builder
