#pragma once
// Collects the points and faces of a reader in a Scan. Common to all formats: drops and counts
// non-finite points, checks faces, limits memory, thins clouds that are too large for it, converts
// colours to bytes.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "colour_scale.hpp"
#include "grid_thinning.hpp"
#include "tactree/builder/read_scan.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// Meaning of a column or property of a point.
enum Slot : std::uint8_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kSlots, kNoSlot };

/// The slot of a column with this name, or kNoSlot. Ignores case.
[[nodiscard]] Slot slot_of_name(std::string_view name);

using PointRow = std::array<double, kSlots>;

class ScanBuilder {
 public:
  /// `place_unit` ("line", "byte", "face") is the unit of a face's position in messages.
  ScanBuilder(std::string file, const ReadOptions& options, std::string place_unit);

  /// Call before the first point.
  void use_normals() { has_normals_ = true; }
  void use_colours(ColourRange range) { begin_colours(range); }
  /// The colours of the next points have a range of their own. Call use_colours() first.
  void begin_colours(ColourRange range) { colours_.begin(range, scan_.colours.size()); }
  /// Removes the colours, of which some points have none.
  void drop_colours();
  /// The file has no faces: ReadOptions::most_points limits its points, which are thinned
  /// (GridThinning), instead of the memory.
  void thin_large_cloud() { thins_ = most_points_ != 0; }

  /// Allocates memory for this many points. Throws ReadError above the limit, unless they are
  /// thinned.
  void reserve_points(std::uint64_t count);
  /// Allocates memory for an estimated number of points, reduced to the limit.
  void expect_points(std::uint64_t count);
  /// Counts memory that the reader allocates itself. Throws ReadError above the limit.
  void charge(std::uint64_t bytes);

  void add_point(const PointRow& row);
  /// Drops the points with this z, and returns their number. Precondition: a file without faces.
  std::size_t drop_height(double z);
  /// Number of points read so far, including dropped ones.
  [[nodiscard]] std::uint64_t points_read() const { return points_read_; }
  /// Number of points kept so far, which is the index of the next point in the scan.
  [[nodiscard]] std::size_t points_kept() const { return scan_.positions.size(); }

  void set_unit(double metres) { scan_.unit_m = metres; }
  /// Begins the points of another scanner, whose position is unknown until set_pose().
  void begin_pose();
  void set_pose(const Eigen::Vector3d& position, bool sure);

  /// Limits the indices of faces to values below `count`; default: points_read() at the end.
  void limit_face_indices(std::uint64_t count) { face_index_limit_ = count; }
  /// Adds a face. `corners` are indices over all points of the file.
  void add_face(std::span<const std::int64_t> corners, std::uint64_t place);
  /// Records the position of a bad face that is detected at the end.
  void set_first_bad_face(std::uint64_t place);

  /// Sets one normal per point of the file. They replace the normals of the rows.
  void set_normals(std::vector<Eigen::Vector3f> normals);

  void count_dropped(const std::string& cause, std::uint64_t count = 1);
  void note(std::string sentence) { scan_.notes.push_back(std::move(sentence)); }
  void warn(std::string sentence) { scan_.warnings.push_back(std::move(sentence)); }

  /// Warns that the header declares fewer of these ("points", "faces") than the file holds.
  void warn_of_more(const std::string& what, std::uint64_t declared, std::uint64_t there);

  /// Returns the scan. Throws ReadError if no point is usable, or if there are faces and none is
  /// usable.
  [[nodiscard]] Scan finish(std::string format);

 private:
  static constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();
  static constexpr const char* kFaceNonFinite = "face_non_finite";

  [[nodiscard]] bool has_colours() const { return colours_.range() != ColourRange::kNone; }
  [[nodiscard]] std::uint64_t bytes_for(std::uint64_t points, std::uint64_t triangles) const;
  [[nodiscard]] std::uint64_t points_that_fit() const;
  /// `points` is the declared number, if it is known to be too large.
  [[noreturn]] void throw_too_large(std::uint64_t points = 0) const;
  void set_point_capacity(std::uint64_t count);
  /// Returns the new capacity of a list of `size` entries that needs `more`. `other_bytes` is all
  /// other memory. Throws ReadError above the limit.
  [[nodiscard]] std::uint64_t grown_capacity(std::uint64_t size, std::uint64_t more,
                                             std::uint64_t entry_bytes,
                                             std::uint64_t other_bytes) const;
  void make_room();
  void thin(std::size_t most);
  void keep_points(std::span<const std::uint8_t> kept);
  void note_thinning();
  void drop_unused_poses();
  void add_normal(const PointRow& row);
  void add_colour(const PointRow& row);
  void check_colours();
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
  std::uint64_t most_points_;
  std::string place_unit_;
  Scan scan_;
  bool has_normals_ = false;
  ColourScale colours_;
  std::uint64_t extra_bytes_ = 0;
  std::uint64_t points_read_ = 0;
  std::uint64_t missing_normals_ = 0;
  std::uint64_t non_finite_ = 0;
  std::vector<std::uint32_t> dropped_;  // of a mesh: indices of the non-finite points, ascending
  bool thins_ = false;
  std::uint64_t thinned_ = 0;  // points dropped
  GridThinning thinning_;
  std::uint64_t face_index_limit_;
  std::uint64_t faces_read_ = 0;
  std::uint64_t bad_faces_ = 0;
  std::uint64_t first_bad_place_ = 0;    // 0: unknown
  std::vector<std::uint32_t> polygons_;  // faces with four or more vertices: count, vertices
};

}  // namespace tactree::builder
