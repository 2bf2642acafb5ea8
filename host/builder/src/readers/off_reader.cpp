// OFF, the Object File Format of Geomview: a keyword, counts, rows of points, rows of faces.
// assimp is not used here: it stores float coordinates and ignores colours.

#include <fmt/format.h>

#include <algorithm>

#include "number.hpp"
#include "readers.hpp"
#include "remedies.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

class OffReader {
 public:
  OffReader(InputFile& file, const ReadOptions& options)
      : file_(file), builder_(file.name(), options, "line") {}

  Scan read() {
    read_counts(read_keyword());
    builder_.limit_face_indices(points_);
    for (std::uint64_t i = 0; i < points_; ++i) read_point(i);
    for (std::uint64_t i = 0; i < faces_; ++i) read_face(i);
    warn_of_more_rows();
    return builder_.finish("OFF");
  }

 private:
  /// Reads the next line that is not blank or a comment. Returns false at the end.
  bool next_row(std::string_view& row) {
    std::string_view line;
    while (file_.next_line(line)) {
      row = trim(line.substr(0, line.find('#')));
      if (!row.empty()) return true;
    }
    return false;
  }

  void warn_of_more_rows() {
    std::uint64_t more = 0;
    std::string_view row;
    while (next_row(row)) ++more;
    if (more == 0) return;
    const bool mesh = faces_ > 0;
    const std::uint64_t declared = mesh ? faces_ : points_;
    builder_.warn_of_more(mesh ? "faces" : "points", declared, declared + more);
  }

  /// Returns the rest of the line after the keyword. The counts may follow it without a space, and
  /// it is missing in some files.
  std::string_view read_keyword() {
    std::string_view row;
    if (!next_row(row)) fail("the file ends before its counts");
    const std::size_t digit = std::min(row.find_first_of("0123456789"), row.size());
    if (digit == 0) return row;
    if (row.starts_with("OFF") && digit == 3) return row.substr(3);
    const std::string_view keyword = take_word(row);
    has_normals_ = keyword.find('N') != std::string_view::npos;
    // Texture coordinates are last, in the columns that would hold the colour.
    has_texture_ = keyword.starts_with("ST");
    if (has_normals_) builder_.use_normals();
    return row;
  }

  void read_counts(std::string_view row) {
    if (trim(row).empty() && !next_row(row)) fail("the file ends before its counts");
    points_ = count(take_word(row), "points");
    faces_ = count(take_word(row), "faces");
    const std::uint64_t room = (file_.remaining() + 1) / 6;  // "0 0 0\n"
    if (points_ > room) {
      fail(fmt::format("{} points are declared, the file has room for at most {}", points_, room));
    }
    if (points_ == 0) fail("the file contains no points: its header declares 0 points");
    const std::uint64_t face_room = (file_.remaining() + 1) / 2;  // "0\n"
    if (faces_ > face_room) {
      fail(fmt::format("{} faces are declared, the file has room for at most {}", faces_,
                       face_room));
    }
  }

  std::uint64_t count(std::string_view word, const char* what) const {
    std::int64_t value = 0;
    if (!parse_integer(word, value) || value < 0) {
      fail(fmt::format("\"{}\" is not a number of {}", printable(word), what));
    }
    return static_cast<std::uint64_t>(value);
  }

  void read_point(std::uint64_t index) {
    std::string_view row;
    if (!next_row(row)) {
      fail(fmt::format("the file ends after {} of {} points", index, points_));
    }
    values_.clear();
    double value = 0;
    while (values_.size() < 12 && parse_number(take_word(row), value)) values_.push_back(value);
    const std::size_t needed = has_normals_ ? 6 : 3;
    if (values_.size() < needed) fail(fmt::format("the point has fewer than {} numbers", needed));
    if (index == 0 && !has_texture_ && values_.size() >= needed + 3) {
      has_colours_ = true;
      builder_.use_colours(ColourRange::kAuto);
    }
    if (index == 0) builder_.reserve_points(points_);
    PointRow point{};
    std::copy_n(values_.begin(), needed, point.begin());  // kX .. kNz
    if (has_colours_ && values_.size() >= needed + 3) {
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(needed), 3, point.begin() + kRed);
    }
    builder_.add_point(point);
  }

  void read_face(std::uint64_t index) {
    std::string_view row;
    if (!next_row(row)) {
      fail(fmt::format("the file ends after {} of {} faces", index, faces_));
    }
    const std::uint64_t corners = count(take_word(row), "corners");
    corners_.clear();
    for (std::uint64_t i = 0; i < corners; ++i) {
      const std::string_view word = take_word(row);
      std::int64_t corner = 0;
      if (!parse_corner(word, corner)) {
        fail(fmt::format("vertex {} of {} of the face is not a number", i + 1, corners));
      }
      corners_.push_back(corner);
    }
    builder_.add_face(corners_, file_.line_number());
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyDamaged);
  }

  InputFile& file_;
  ScanBuilder builder_;
  std::uint64_t points_ = 0;
  std::uint64_t faces_ = 0;
  bool has_normals_ = false;
  bool has_texture_ = false;
  bool has_colours_ = false;
  std::vector<double> values_;
  std::vector<std::int64_t> corners_;
};

}  // namespace

Scan read_off(InputFile& file, const ReadOptions& options) {
  return OffReader(file, options).read();
}

}  // namespace tactree::builder
