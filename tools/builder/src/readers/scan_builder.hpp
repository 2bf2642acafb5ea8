#pragma once
// Gathers the points and faces that a reader finds into a Scan. Here, once for all formats, lies
// what every reader owes the user: non-finite points dropped and counted, faces checked, memory
// bounded, colours brought to one scale.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// What a column or property of a point means.
enum Slot : std::uint8_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kSlots, kNoSlot };

/// The slot that a column of this name fills, or kNoSlot. Ignores case.
[[nodiscard]] Slot slot_of_name(std::string_view name);

using PointRow = std::array<double, kSlots>;

enum class ColourRange : std::uint8_t {
  kNone,
  kByte,  ///< 0 .. 255
  kWord,  ///< 0 .. 65535
  kAuto,  ///< 0 .. 1, or 0 .. 255 once a value above 1.5 was seen
};

class ScanBuilder {
 public:
  /// `place_unit` ("line", "byte", "face") says what the place of a face is counted in.
  ScanBuilder(std::string file, std::uint64_t memory_bytes, std::string place_unit);

  /// Before the first point.
  void use_normals() { has_normals_ = true; }
  void use_colours(ColourRange range) { colours_ = range; }

  /// Takes memory for this many points. Throws ReadError when that is above the limit.
  void reserve_points(std::uint64_t count);
  /// The same for an estimate, which may be wrong: takes less rather than throw.
  void expect_points(std::uint64_t count);
  /// Counts memory that the reader takes besides; throws ReadError above the limit.
  void charge(std::uint64_t bytes);

  void add_point(const PointRow& row);
  /// All points so far, those dropped included.
  [[nodiscard]] std::uint64_t points_read() const { return points_read_; }

  /// Faces may only name points below `count`; without this, below points_read() at the end.
  void limit_face_indices(std::uint64_t count) { face_index_limit_ = count; }
  /// A face by its corners, as indices over all points of the file.
  void add_face(std::span<const std::int64_t> corners, std::uint64_t place);
  [[nodiscard]] std::uint64_t faces_read() const { return faces_read_; }
  /// For a face found bad only at the end.
  void set_first_bad_face(std::uint64_t place);

  /// One normal per point of the file, to use instead of those in the rows.
  void set_normals(std::vector<Eigen::Vector3f> normals);

  void count_dropped(const std::string& cause, std::uint64_t count = 1);
  void warn(std::string sentence) { scan_.warnings.push_back(std::move(sentence)); }

  /// The result. Throws ReadError when no point, or of some faces none, is usable.
  [[nodiscard]] Scan finish(std::string format);

 private:
  [[nodiscard]] std::uint64_t bytes_for(std::uint64_t points, std::uint64_t triangles) const;
  [[nodiscard]] std::uint64_t points_that_fit() const;
  /// points: how many are promised, when they are known to be too many.
  [[noreturn]] void throw_too_large(std::uint64_t points = 0) const;
  void set_point_capacity(std::uint64_t count);
  /// The capacity that a list of `size` entries moves to for `more` of them. Throws ReadError when
  /// that is above the limit; other_bytes is all that is taken besides.
  [[nodiscard]] std::uint64_t grown_capacity(std::uint64_t size, std::uint64_t more,
                                             std::uint64_t entry_bytes,
                                             std::uint64_t other_bytes) const;
  void grow_points();
  void add_normal(const PointRow& row);
  void add_colour(const PointRow& row);
  void leave_unit_colours();
  void drop_point();
  void add_polygon(std::span<const std::int64_t> corners);
  void add_triangle(const std::array<std::uint32_t, 3>& triangle);
  void count_bad_face(const char* cause, std::uint64_t place);

  [[nodiscard]] std::uint32_t kept_index(std::uint32_t index) const;
  [[nodiscard]] bool keep_face(std::span<std::uint32_t> corners);
  void check_triangles();
  void cut_polygons();
  void check_points_left() const;
  void check_faces_left() const;
  void warn_of_damage();

  std::string file_;
  std::uint64_t memory_bytes_;
  std::string place_unit_;
  Scan scan_;
  bool has_normals_ = false;
  ColourRange colours_ = ColourRange::kNone;
  bool unit_colours_ = true;  // of kAuto: no value above 1.5 so far
  std::uint64_t extra_bytes_ = 0;
  std::uint64_t points_read_ = 0;
  std::uint64_t missing_normals_ = 0;
  std::vector<std::uint32_t> dropped_;  // indices of the non-finite points, rising
  std::uint64_t face_index_limit_;
  std::uint64_t faces_read_ = 0;
  std::uint64_t bad_faces_ = 0;
  std::uint64_t first_bad_place_ = 0;    // 0: not known
  std::vector<std::uint32_t> polygons_;  // of each face with four or more corners: count, corners
};

}  // namespace tactree::builder
