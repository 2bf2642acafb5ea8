// OBJ (Wavefront): lines of points, normals and faces. assimp is not used here: it stores float
// coordinates (6 cm apart at 10^6 m) and splits points by the normals of their corners.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "number.hpp"
#include "readers.hpp"
#include "remedies.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::int64_t kNoIndex = -1;
constexpr float kSameDirection = 0.9998F;  // cosine of about one degree
constexpr std::size_t kMaxForwardFaces = 4096;

bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_free_form(std::string_view keyword) {
  constexpr std::array<std::string_view, 7> kFreeForm = {"surf", "curv", "curv2", "bsp",
                                                         "bzp",  "cdp",  "cdc"};
  return is_one_of(keyword, kFreeForm);
}

/// True for a line of numbers, which a '\' at its end joins with the next line. In names and
/// comments a '\' is a character like any other, as at the end of a path of Windows.
bool is_of_numbers(std::string_view line) {
  constexpr std::array<std::string_view, 12> kOfNumbers = {
      "v", "vn", "vt", "vp", "f", "fo", "l", "p", "parm", "trim", "hole", "scrv"};
  const std::string_view keyword = take_word(line);
  return is_one_of(keyword, kOfNumbers) || is_free_form(keyword);
}

bool continues(std::string_view line) {
  return line.find('#') == line.npos && trim(line).ends_with('\\');
}

/// One normal per point, if the corners of its faces agree.
class CornerNormals {
 public:
  explicit CornerNormals(ScanBuilder& builder) : builder_(builder) {}

  void add(const Eigen::Vector3f& normal) {
    if (normals_.size() == normals_.capacity()) {
      const std::size_t more = std::max<std::size_t>(1024, normals_.size());
      builder_.charge(more * sizeof(Eigen::Vector3f));
      normals_.reserve(normals_.size() + more);
    }
    normals_.push_back(normal);
  }

  [[nodiscard]] std::size_t count() const { return normals_.size(); }

  void use(std::int64_t point, std::int64_t normal) {
    if (disagree_ || point < 0 || normal < 0) return;
    if (static_cast<std::size_t>(normal) >= normals_.size()) return;
    if (static_cast<std::uint64_t>(point) >= builder_.points_read()) return;
    const auto at = static_cast<std::size_t>(point);
    if (at >= of_point_.size()) grow_to(at + 1);
    const auto index = static_cast<std::uint32_t>(normal) + 1;
    if (of_point_[at] == 0) of_point_[at] = index;
    if (of_point_[at] == index) return;
    const Eigen::Vector3f first = normals_[of_point_[at] - 1].normalized();
    if (!(first.dot(normals_[index - 1].normalized()) > kSameDirection)) disagree_ = true;
  }

  /// Passes the normals to the builder, if there are any.
  void finish() {
    if (normals_.empty()) return;
    if (disagree_) {
      builder_.warn("The normals were ignored: at edges they differ between the faces of a point.");
      return;
    }
    const auto points = static_cast<std::size_t>(builder_.points_read());
    if (of_point_.empty()) {
      // No face refers to the normals: in a cloud, they are in the order of the points.
      if (normals_.size() == points) builder_.set_normals(std::move(normals_));
      return;
    }
    builder_.charge(points * sizeof(Eigen::Vector3f));
    std::vector<Eigen::Vector3f> result(points, Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < of_point_.size(); ++i) {
      if (of_point_[i] != 0) result[i] = normals_[of_point_[i] - 1];
    }
    builder_.set_normals(std::move(result));
  }

 private:
  void grow_to(std::size_t size) {
    if (size > of_point_.capacity()) {
      const std::size_t capacity = std::max(2 * of_point_.capacity(), size);
      builder_.charge((capacity - of_point_.capacity()) * sizeof(std::uint32_t));
      of_point_.reserve(capacity);
    }
    of_point_.resize(size, 0);
  }

  ScanBuilder& builder_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<std::uint32_t> of_point_;  // index into normals_ plus one, 0: none
  bool disagree_ = false;
};

class ObjReader {
 public:
  /// `first_index` is that of the points and normals: 1, or 0 in the files of some programs.
  ObjReader(InputFile& file, const ReadOptions& options, std::int64_t first_index)
      : file_(file),
        first_index_(first_index),
        builder_(file.name(), options, "line"),
        normals_(builder_) {}

  /// Returns nullopt if the indices count from 0 and not from first_index.
  std::optional<Scan> read() {
    find_colours();
    std::string_view line;
    while (next_line(line)) read_line(line);
    const bool from_zero = zero_seen_ && !relative_seen_ && highest_index_ >= 0 &&
                           static_cast<std::uint64_t>(highest_index_) < builder_.points_read();
    if (from_zero && first_index_ == 1) return std::nullopt;
    if (first_index_ == 0) {
      builder_.warn(fmt::format(
          "The indices of the faces are 0 to {} for {} points: they were taken to count from 0, "
          "though an OBJ file counts from 1.",
          highest_index_, builder_.points_read()));
    }
    check_free_form();
    find_bad_forward_face();
    if (has_colours_ && points_without_colour_ > 0) {
      builder_.warn(
          fmt::format("{} points have no colour and became white.", points_without_colour_));
    }
    normals_.finish();
    return builder_.finish("OBJ");
  }

 private:
  /// Searches the first lines for points with a colour, because the builder must know at the first
  /// point whether there are colours, and a point without one becomes white.
  void find_colours() {
    file_.rewind();
    constexpr std::size_t kSampleLines = 10000;
    std::string_view line;
    for (std::size_t i = 0; i < kSampleLines && file_.next_line(line); ++i) {
      if (take_word(line) != "v" || parse_values(line) < 6) continue;
      has_colours_ = true;
      note_white();
    }
    if (has_colours_) builder_.use_colours(ColourRange::kAuto);
    file_.rewind();
  }

  /// Reads a line, joined with its continuations (a '\' at the end).
  bool next_line(std::string_view& line) {
    if (!file_.next_line(line)) return false;
    if (!continues(line) || !is_of_numbers(line)) return true;
    joined_.clear();
    while (continues(line)) {
      joined_.append(line.substr(0, line.rfind('\\'))).push_back(' ');
      if (joined_.size() > InputFile::kMaxLineBytes) fail("the line is longer than 1 MiB");
      if (!file_.next_line(line)) line = {};
    }
    joined_.append(line);
    line = joined_;
    return true;
  }

  void read_line(std::string_view line) {
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = take_word(line);
    if (keyword == "v") return read_point(line);
    if (keyword == "vn") return read_normal(line);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (is_free_form(keyword) && free_form_++ == 0) first_free_form_ = file_.line_place();
  }

  /// The points of curves and surfaces lie beside them.
  void check_free_form() {
    if (free_form_ == 0) return;
    if (!has_faces_) {
      throw ReadError(file_.name(), first_free_form_,
                      "the file holds curves or surfaces (NURBS) and no faces",
                      "tessellate it before the export: save it as a mesh");
    }
    builder_.warn(
        fmt::format("{}: {} curves or surfaces (NURBS) were left out, the first at {} (tessellate "
                    "them before the export)",
                    file_.name(), free_form_, first_free_form_));
  }

  /// Parses the numbers into values_ and returns their count.
  std::size_t parse_values(std::string_view rest) {
    std::size_t count = 0;
    while (count < values_.size() && parse_number(take_word(rest), values_[count])) ++count;
    return count;
  }

  /// Raises white_ to the range of the colour in values_.
  void note_white() {
    const double highest = *std::max_element(values_.begin() + 3, values_.begin() + 6);
    if (highest > 1.5) white_ = std::max(white_, 255.0);
    if (highest > 255.5) white_ = 65535.0;
  }

  void read_point(std::string_view rest) {
    const std::size_t count = parse_values(rest);
    if (count < 3) fail("the point has fewer than three numbers");
    PointRow row{};
    std::copy_n(values_.begin(), 3, row.begin());
    if (has_colours_) {
      // "x y z w" has no colour, "x y z r g b" and "x y z r g b a" have.
      const bool coloured = count >= 6;
      if (coloured) {
        note_white();
      } else {
        ++points_without_colour_;
      }
      for (std::size_t i = 0; i < 3; ++i) row[kRed + i] = coloured ? values_[3 + i] : white_;
    }
    builder_.add_point(row);
  }

  void read_normal(std::string_view rest) {
    if (parse_values(rest) < 3) fail("the normal has fewer than three numbers");
    normals_.add({static_cast<float>(values_[0]), static_cast<float>(values_[1]),
                  static_cast<float>(values_[2])});
  }

  /// Corners are "point", "point/texture", "point//normal" or "point/texture/normal".
  void read_face(std::string_view rest) {
    has_faces_ = true;
    corners_.clear();
    std::int64_t highest = kNoIndex;
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const std::size_t slash = word.find('/');
      const std::int64_t point = to_index(word.substr(0, slash), builder_.points_read());
      note_index(word.substr(0, slash));
      highest = std::max(highest, point);
      corners_.push_back(point);
      if (slash == std::string_view::npos) continue;
      const std::size_t second = word.find('/', slash + 1);
      if (second == std::string_view::npos) continue;
      normals_.use(point, to_index(word.substr(second + 1), normals_.count()));
    }
    const bool forward =
        highest != kNoIndex && static_cast<std::uint64_t>(highest) >= builder_.points_read();
    if (forward && forward_faces_.size() < kMaxForwardFaces) {
      forward_faces_.push_back({highest, file_.line_number()});
    }
    builder_.add_face(corners_, file_.line_number());
  }

  /// Records the index. Only at the end of the file is it known whether indices count from 0.
  void note_index(std::string_view word) {
    std::int64_t value = 0;
    if (!parse_integer(word, value)) return;
    zero_seen_ = zero_seen_ || value == 0;
    relative_seen_ = relative_seen_ || value < 0;
    highest_index_ = std::max(highest_index_, value);
  }

  /// Indices count from first_index_, or backwards from the latest if negative.
  [[nodiscard]] std::int64_t to_index(std::string_view word, std::uint64_t count) const {
    std::int64_t value = 0;
    if (!parse_integer(word, value)) return kNoIndex;
    if (value >= first_index_) return value - first_index_;
    if (value == 0) return kNoIndex;
    const auto known = static_cast<std::int64_t>(count);
    return value >= -known ? known + value : kNoIndex;
  }

  /// Faces may precede their points, so invalid indices are known only at the end of the file.
  void find_bad_forward_face() {
    for (const ForwardFace& face : forward_faces_) {
      if (static_cast<std::uint64_t>(face.highest) < builder_.points_read()) continue;
      builder_.set_first_bad_face(face.line);
      return;
    }
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyDamaged);
  }

  struct ForwardFace {
    std::int64_t highest;
    std::uint64_t line;
  };

  InputFile& file_;
  std::int64_t first_index_;
  bool zero_seen_ = false;
  bool relative_seen_ = false;
  std::int64_t highest_index_ = -1;
  ScanBuilder builder_;
  CornerNormals normals_;
  bool has_faces_ = false;
  std::uint64_t free_form_ = 0;
  std::string first_free_form_;
  bool has_colours_ = false;
  double white_ = 1.0;
  std::uint64_t points_without_colour_ = 0;
  std::array<double, 8> values_{};
  std::vector<std::int64_t> corners_;
  std::vector<ForwardFace> forward_faces_;
  std::string joined_;
};

}  // namespace

Scan read_obj(InputFile& file, const ReadOptions& options) {
  if (std::optional<Scan> scan = ObjReader(file, options, 1).read()) return *std::move(scan);
  return ObjReader(file, options, 0).read().value();
}

}  // namespace tactree::builder
