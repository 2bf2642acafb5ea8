// The faces of a scan: see scan_builder.hpp.

#include <fmt/format.h>

#include <algorithm>

#include "polygon.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr const char* kDegenerateFace = "degenerate_face";
constexpr const char* kFaceIndexOutOfRange = "face_index_out_of_range";

bool has_equal_corners(std::span<const std::uint32_t> t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

}  // namespace

void ScanBuilder::set_first_bad_face(std::uint64_t place) {
  if (first_bad_place_ == 0 || place < first_bad_place_) first_bad_place_ = place;
}

void ScanBuilder::count_bad_face(const char* cause, std::uint64_t place) {
  ++bad_faces_;
  count_dropped(cause);
  if (place != 0 && first_bad_place_ == 0) first_bad_place_ = place;
}

void ScanBuilder::add_face(std::span<const std::int64_t> corners, std::uint64_t place) {
  ++faces_read_;
  for (const std::int64_t corner : corners) {
    if (static_cast<std::uint64_t>(corner) >= face_index_limit_) {  // negative ones as well
      count_bad_face(kFaceIndexOutOfRange, place);
      return;
    }
  }
  if (corners.size() < 3) {
    count_bad_face(kDegenerateFace, place);
    return;
  }
  if (corners.size() == 3) {
    const std::array<std::uint32_t, 3> triangle = {static_cast<std::uint32_t>(corners[0]),
                                                   static_cast<std::uint32_t>(corners[1]),
                                                   static_cast<std::uint32_t>(corners[2])};
    if (has_equal_corners(triangle)) {
      count_bad_face(kDegenerateFace, place);
      return;
    }
    add_triangle(triangle);
    return;
  }
  add_polygon(corners);
}

void ScanBuilder::add_polygon(std::span<const std::int64_t> corners) {
  const std::size_t size = polygons_.size();
  if (polygons_.capacity() - size <= corners.size()) {
    const std::uint64_t entry_bytes = sizeof(std::uint32_t);
    const std::uint64_t all = bytes_for(scan_.positions.capacity(), scan_.triangles.capacity());
    polygons_.reserve(static_cast<std::size_t>(grown_capacity(
        size, corners.size() + 1, entry_bytes, all - entry_bytes * polygons_.capacity())));
  }
  polygons_.push_back(static_cast<std::uint32_t>(corners.size()));
  for (const std::int64_t corner : corners) polygons_.push_back(static_cast<std::uint32_t>(corner));
}

void ScanBuilder::add_triangle(const std::array<std::uint32_t, 3>& triangle) {
  if (scan_.triangles.size() == scan_.triangles.capacity()) {
    const std::uint64_t other = bytes_for(scan_.positions.capacity(), 0);
    scan_.triangles.reserve(static_cast<std::size_t>(
        grown_capacity(scan_.triangles.size(), 1, sizeof triangle, other)));
  }
  scan_.triangles.push_back(triangle);
}

/// Index in the scan of a point of the file, or kDropped.
std::uint32_t ScanBuilder::kept_index(std::uint32_t index) const {
  const auto next = std::lower_bound(dropped_.begin(), dropped_.end(), index);
  if (next != dropped_.end() && *next == index) return kDropped;
  return index - static_cast<std::uint32_t>(next - dropped_.begin());
}

/// Converts vertices to indices of the scan. If a vertex is invalid, counts the face and returns
/// false.
bool ScanBuilder::keep_face(std::span<std::uint32_t> corners) {
  for (const std::uint32_t corner : corners) {
    if (corner >= points_read_) {
      count_bad_face(kFaceIndexOutOfRange, 0);
      return false;
    }
  }
  if (dropped_.empty()) return true;
  for (std::uint32_t& corner : corners) {
    corner = kept_index(corner);
    if (corner == kDropped) {
      count_dropped(kFaceNonFinite);
      return false;
    }
  }
  return true;
}

void ScanBuilder::check_triangles() {
  std::size_t kept = 0;
  for (std::array<std::uint32_t, 3> triangle : scan_.triangles) {
    if (keep_face(triangle)) scan_.triangles[kept++] = triangle;
  }
  scan_.triangles.resize(kept);
}

void ScanBuilder::cut_polygons() {
  PolygonCutter cutter(scan_.positions);
  for (std::size_t at = 0; at < polygons_.size(); at += 1 + polygons_[at]) {
    const std::span<std::uint32_t> corners{&polygons_[at + 1], polygons_[at]};
    if (!keep_face(corners)) continue;
    bool any = false;
    for (const auto& triangle : cutter.cut(corners)) {
      if (has_equal_corners(triangle)) continue;
      any = true;
      add_triangle(triangle);
    }
    if (!any) count_bad_face(kDegenerateFace, 0);
  }
  if (cutter.gave_up()) {
    warn("Some of the polygons with very many vertices were triangulated as fans.");
  }
  polygons_ = {};
}

void ScanBuilder::check_faces_left() const {
  if (bad_faces_ == 0 || !scan_.triangles.empty()) return;
  const bool placed = first_bad_place_ != 0;
  throw ReadError(file_, placed ? fmt::format("{} {}", place_unit_, first_bad_place_) : "",
                  fmt::format("none of the {} faces is usable: they refer to points that the file "
                              "does not have, or have fewer than three distinct vertices",
                              faces_read_),
                  "export the mesh again, or delete the faces to use only the points");
}

}  // namespace tactree::builder
