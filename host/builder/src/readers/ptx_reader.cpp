// Leica PTX: one or more scans. Each has the number of its columns and of the points of a column,
// the position and the axes of the scanner, the matrix from the scanner's frame to that of the file
// (its last row is the translation), then a line per point, column by column: x y z intensity, and
// optionally red green blue. A point that was not measured is 0 0 0.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "number.hpp"
#include "range_image.hpp"
#include "readers.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kLeastRowBytes = 8;  // "0 0 0 0", and the end of the line
constexpr std::size_t kPlainValues = 4;
constexpr std::size_t kColourValues = 7;
constexpr double kAffine = 1e-6;

Eigen::Vector3d unknown() {
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

class PtxReader {
 public:
  PtxReader(InputFile& file, const ReadOptions& options)
      : file_(file), builder_(file.name(), options, "line") {
    builder_.thin_large_cloud();
  }

  Scan read() {
    std::string_view line;
    while (next_line(line)) {
      ++scans_;
      read_scan(line);
    }
    if (missing_ > 0) builder_.count_dropped("not_measured", missing_);
    if (unknown_ > 0) {
      builder_.warn(fmt::format(
          "In {} of {} scans the order of the points does not fit the position of the scanner; it "
          "was ignored (give --viewpoint X,Y,Z of the scanner).",
          unknown_, scans_));
    }
    drop_incomplete_colours();
    return builder_.finish("PTX");
  }

 private:
  void read_scan(std::string_view first_line) {
    const std::uint64_t columns = count(first_line);
    const std::uint64_t rows = count(demand_line());
    check_room(columns, rows);
    const Eigen::Affine3d to_file = read_frame();
    RangeImage image(rows, to_file.translation(), true);
    const std::uint64_t before = builder_.points_read();
    builder_.begin_pose();
    for (std::uint64_t i = 0; i < columns * rows; ++i) {
      std::string_view line;
      if (!next_line(line)) fail_truncated(i, columns * rows);
      image.add(read_point(line, to_file));
    }
    if (const std::optional<ScannerPose> pose = image.pose()) {
      builder_.set_pose(pose->position, true);
    } else if (builder_.points_read() > before) {
      ++unknown_;
    }
  }

  /// Skips the position and the axes, which the matrix states again.
  Eigen::Affine3d read_frame() {
    for (int i = 0; i < 4; ++i) numbers<3>(demand_line());
    Eigen::Matrix4d matrix;
    for (int i = 0; i < 4; ++i) {
      const std::array<double, 4> row = numbers<4>(demand_line());
      matrix.col(i) << row[0], row[1], row[2], row[3];
    }
    const bool affine =
        (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < kAffine;
    if (!matrix.allFinite() || !affine || matrix.topLeftCorner<3, 3>().determinant() == 0.0) {
      fail_line("the matrix of the scanner is not a rotation and a translation");
    }
    return Eigen::Affine3d(matrix);
  }

  /// Returns the point in the frame of the file; NaN if it was not measured.
  Eigen::Vector3d read_point(std::string_view line, const Eigen::Affine3d& to_file) {
    std::array<double, kColourValues> values{};
    const std::size_t there = parse(line, values);
    if (there < kPlainValues) {
      fail_line(fmt::format("the row has fewer than {} values", kPlainValues));
    }
    const Eigen::Vector3d local(values[0], values[1], values[2]);
    if (local.isZero(0.0)) {  // of any number of values
      ++missing_;
      return unknown();
    }
    count_colour(there);
    const Eigen::Vector3d at = to_file * local;
    PointRow row{};
    row[kX] = at.x();
    row[kY] = at.y();
    row[kZ] = at.z();
    row[kRed] = values[4];
    row[kGreen] = values[5];
    row[kBlue] = values[6];
    builder_.add_point(row);
    return at;
  }

  /// The first point decides whether the points have colours.
  void count_colour(std::size_t values) {
    if (coloured_ > 0 && values != kPlainValues && values != kColourValues) {
      fail_line(fmt::format("the row has fewer than {} values", kColourValues));
    }
    if (coloured_ + plain_ == 0 && values == kColourValues) {
      builder_.use_colours(ColourRange::kWordOrByte);
    }
    ++(values == kColourValues ? coloured_ : plain_);
  }

  void drop_incomplete_colours() {
    if (coloured_ == 0 || plain_ == 0) return;
    builder_.drop_colours();
    builder_.warn(fmt::format("Only {} of {} points have colours, which were therefore ignored.",
                              coloured_, coloured_ + plain_));
  }

  /// Parses the numbers of a line, at most as many as `values` has room for. Returns their number.
  std::size_t parse(std::string_view rest, std::span<double> values) const {
    std::size_t there = 0;
    for (double& value : values) {
      const std::string_view word = take_word(rest);
      if (word.empty()) break;
      if (!parse_number(word, value)) {
        fail_line(fmt::format("\"{}\" is not a number", printable(word)));
      }
      ++there;
    }
    return there;
  }

  template <std::size_t N>
  std::array<double, N> numbers(std::string_view line) const {
    std::array<double, N> values{};
    if (parse(line, values) < N) fail_line(fmt::format("the line has fewer than {} values", N));
    return values;
  }

  [[nodiscard]] std::uint64_t count(std::string_view line) const {
    std::int64_t value = 0;
    if (!parse_integer(trim(line), value) || value < 1) {
      fail_line(fmt::format("\"{}\" is not the number of columns or rows of scan {}",
                            printable(line), scans_));
    }
    return static_cast<std::uint64_t>(value);
  }

  void check_room(std::uint64_t columns, std::uint64_t rows) {
    const std::uint64_t room = (file_.remaining() + 1) / kLeastRowBytes;
    std::uint64_t points = 0;
    if (__builtin_mul_overflow(columns, rows, &points) || points > room) {
      fail_line(fmt::format("scan {} declares {} x {} points; there is room for {}", scans_,
                            columns, rows, room));
    }
    if (scans_ == 1) builder_.expect_points(points);
  }

  bool next_line(std::string_view& line) {
    while (file_.next_line(line)) {
      if (!trim(line).empty()) return true;
    }
    return false;
  }

  std::string_view demand_line() {
    std::string_view line;
    if (!next_line(line)) fail_line(fmt::format("the header of scan {} is not complete", scans_));
    return line;
  }

  [[noreturn]] void fail_truncated(std::uint64_t there, std::uint64_t declared) const {
    fail_line(
        fmt::format("the file ends too early: scan {} declares {} points, only {} are present",
                    scans_, declared, there));
  }
  [[noreturn]] void fail_line(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyAgain);
  }

  InputFile& file_;
  ScanBuilder builder_;
  std::uint64_t coloured_ = 0;  // measured points
  std::uint64_t plain_ = 0;     // those without a colour
  std::uint64_t scans_ = 0;
  std::uint64_t missing_ = 0;
  std::uint64_t unknown_ = 0;  // scans without a pose
};

}  // namespace

Scan read_ptx(InputFile& file, const ReadOptions& options) {
  return PtxReader(file, options).read();
}

}  // namespace tactree::builder
