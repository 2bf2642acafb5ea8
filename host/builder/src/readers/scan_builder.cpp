#include "scan_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "number.hpp"
#include "tactree/builder/length_text.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kMaxEntries = std::numeric_limits<std::uint32_t>::max() - 1;
constexpr const char* kNonFinite = "non_finite";
constexpr std::uint64_t kLeastMost = 4;  // a list of fewer points has no room when it is thinned

struct SlotName {
  std::string_view name;
  Slot slot;
};

constexpr SlotName kSlotNames[] = {
    {"x", kX},
    {"y", kY},
    {"z", kZ},
    {"points:0", kX},
    {"points:1", kY},
    {"points:2", kZ},
    {"nx", kNx},
    {"ny", kNy},
    {"nz", kNz},
    {"normal_x", kNx},
    {"normal_y", kNy},
    {"normal_z", kNz},
    {"normalx", kNx},
    {"normaly", kNy},
    {"normalz", kNz},
    {"normals:0", kNx},
    {"normals:1", kNy},
    {"normals:2", kNz},
    {"red", kRed},
    {"green", kGreen},
    {"blue", kBlue},
    {"r", kRed},
    {"g", kGreen},
    {"b", kBlue},
    {"rf", kRed},
    {"gf", kGreen},
    {"bf", kBlue},
    {"diffuse_red", kRed},
    {"diffuse_green", kGreen},
    {"diffuse_blue", kBlue},
};

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{:.0f} MiB", std::ceil(static_cast<double>(bytes) / (1 << 20)));
}

}  // namespace

Slot slot_of_name(std::string_view name) {
  for (const SlotName& known : kSlotNames) {
    if (equal_ignoring_case(known.name, name)) return known.slot;
  }
  return kNoSlot;
}

ScanBuilder::ScanBuilder(std::string file, const ReadOptions& options, std::string place_unit)
    : file_(std::move(file)),
      memory_bytes_(options.scan_memory_bytes),
      most_points_(options.most_points),
      place_unit_(std::move(place_unit)),
      face_index_limit_(kDropped) {}

std::uint64_t ScanBuilder::bytes_for(std::uint64_t points, std::uint64_t triangles) const {
  std::uint64_t per_point = sizeof(Eigen::Vector3d);
  if (has_normals_) per_point += sizeof(Eigen::Vector3f);
  if (has_colours()) per_point += 3;
  const std::uint64_t faces = 12 * triangles + 4 * (polygons_.capacity() + dropped_.capacity());
  return per_point * points + faces + extra_bytes_;
}

std::uint64_t ScanBuilder::points_that_fit() const {
  if (thins_) return std::clamp(most_points_, kLeastMost, kMaxEntries);
  const std::uint64_t other = bytes_for(0, scan_.triangles.capacity());
  const std::uint64_t per_point = bytes_for(1, 0) - bytes_for(0, 0);
  const std::uint64_t fit = other >= memory_bytes_ ? 0 : (memory_bytes_ - other) / per_point;
  return std::min(fit, kMaxEntries);
}

void ScanBuilder::throw_too_large(std::uint64_t points) const {
  throw ReadError(
      file_, "",
      fmt::format("the scan is too large: {} points and {} faces exceed the limit of {} of "
                  "memory",
                  std::max(points, points_read_), faces_read_, mebibytes(memory_bytes_)),
      "reduce it first, for example in CloudCompare with Edit > Subsample");
}

void ScanBuilder::set_point_capacity(std::uint64_t count) {
  const auto capacity = static_cast<std::size_t>(count);
  scan_.positions.reserve(capacity);
  if (has_normals_) scan_.normals.reserve(capacity);
  if (has_colours()) scan_.colours.reserve(capacity);
}

void ScanBuilder::reserve_points(std::uint64_t count) {
  if (!thins_ && count > points_that_fit()) throw_too_large(count);
  expect_points(count);
}

void ScanBuilder::expect_points(std::uint64_t count) {
  set_point_capacity(std::min(count, points_that_fit()));
}

void ScanBuilder::charge(std::uint64_t bytes) {
  extra_bytes_ += bytes;
  if (bytes_for(scan_.positions.capacity(), scan_.triangles.capacity()) > memory_bytes_) {
    throw_too_large();
  }
}

std::uint64_t ScanBuilder::grown_capacity(std::uint64_t size, std::uint64_t more,
                                          std::uint64_t entry_bytes,
                                          std::uint64_t other_bytes) const {
  const std::uint64_t needed = size + more;
  const std::uint64_t fit =
      other_bytes >= memory_bytes_ ? 0 : (memory_bytes_ - other_bytes) / entry_bytes;
  const std::uint64_t capacity =
      std::min({std::max({std::uint64_t{1024}, 2 * size, needed}), fit, kMaxEntries});
  // Both copies exist while the list grows; a quarter above the limit is reserved for that.
  const std::uint64_t while_moving = other_bytes + 2 * size * entry_bytes;
  if (capacity < needed || while_moving > memory_bytes_ + memory_bytes_ / 4) throw_too_large();
  return capacity;
}

void ScanBuilder::make_room() {
  const std::uint64_t size = scan_.positions.size();
  if (thins_) {
    const std::uint64_t most = points_that_fit();
    if (size < most) return expect_points(std::max(std::uint64_t{1024}, 2 * size));
    return thin(static_cast<std::size_t>(most - most / 4));
  }
  const std::uint64_t other = bytes_for(0, scan_.triangles.capacity());
  set_point_capacity(grown_capacity(size, 1, bytes_for(1, 0) - bytes_for(0, 0), other));
}

/// Keeps at most this many points.
void ScanBuilder::thin(std::size_t most) {
  const std::size_t before = scan_.positions.size();
  keep_points(thinning_.select(scan_.positions, most));
  thinned_ += before - scan_.positions.size();
}

/// Drops the points that are marked with 0.
void ScanBuilder::keep_points(std::span<const std::uint8_t> kept) {
  std::size_t count = 0;
  auto pose = scan_.poses.begin();
  const std::size_t first_colour = colours_.first();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i == first_colour) colours_.set_first(count);
    for (; pose != scan_.poses.end() && pose->first_point == i; ++pose) pose->first_point = count;
    if (kept[i] == 0) continue;
    scan_.positions[count] = scan_.positions[i];
    if (has_normals_) scan_.normals[count] = scan_.normals[i];
    if (has_colours()) scan_.colours[count] = scan_.colours[i];
    ++count;
  }
  for (; pose != scan_.poses.end(); ++pose) pose->first_point = count;
  if (first_colour >= kept.size()) colours_.set_first(count);
  scan_.positions.resize(count);
  if (has_normals_) scan_.normals.resize(count);
  if (has_colours()) scan_.colours.resize(count);
}

std::size_t ScanBuilder::drop_height(double z) {
  std::vector<std::uint8_t> kept;
  kept.reserve(scan_.positions.size());
  for (const Eigen::Vector3d& p : scan_.positions) kept.push_back(p.z() == z ? 0 : 1);
  keep_points(kept);
  return kept.size() - scan_.positions.size();
}

void ScanBuilder::begin_pose() {
  const Eigen::Vector3d unknown =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  scan_.poses.push_back({unknown, scan_.positions.size(), true});
}

void ScanBuilder::set_pose(const Eigen::Vector3d& position, bool sure) {
  scan_.poses.back().position = position;
  scan_.poses.back().sure = sure;
}

/// Drops the poses of no points, and all if none is known.
void ScanBuilder::drop_unused_poses() {
  std::vector<ScannerPose>& poses = scan_.poses;
  std::size_t end = scan_.positions.size();
  std::vector<ScannerPose> used;
  for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
    if (pose->first_point < end) used.push_back(*pose);
    end = pose->first_point;
  }
  std::reverse(used.begin(), used.end());
  const bool known = std::any_of(used.begin(), used.end(),
                                 [](const ScannerPose& pose) { return pose.position.allFinite(); });
  poses = known ? std::move(used) : std::vector<ScannerPose>();
}

void ScanBuilder::note_thinning() {
  const double edge = thinning_.edge();
  note(fmt::format(
      "{}: of {} points, more than the memory limit allows, the first in each cube of {} was kept "
      "while reading: {} (--memory-limit raises it)",
      file_, points_read_ - non_finite_,
      scan_.unit_m ? length_text(edge * *scan_.unit_m)
                   : fmt::format("{:.3g} (in the unit of the file)", edge),
      scan_.positions.size()));
}

void ScanBuilder::add_point(const PointRow& row) {
  if (!std::isfinite(row[kX]) || !std::isfinite(row[kY]) || !std::isfinite(row[kZ])) {
    drop_point();
    return;
  }
  if (scan_.positions.size() == scan_.positions.capacity()) make_room();
  scan_.positions.emplace_back(row[kX], row[kY], row[kZ]);
  if (has_normals_) add_normal(row);
  if (has_colours()) add_colour(row);
  ++points_read_;
}

void ScanBuilder::drop_point() {
  ++non_finite_;
  if (thins_) {  // no face refers to it
    ++points_read_;
    return;
  }
  if (dropped_.size() == dropped_.capacity()) {
    const std::uint64_t entry_bytes = sizeof(std::uint32_t);
    const std::uint64_t all = bytes_for(scan_.positions.capacity(), scan_.triangles.capacity());
    dropped_.reserve(static_cast<std::size_t>(
        grown_capacity(dropped_.size(), 1, entry_bytes, all - entry_bytes * dropped_.size())));
  }
  dropped_.push_back(static_cast<std::uint32_t>(points_read_));
  ++points_read_;
}

void ScanBuilder::add_normal(const PointRow& row) {
  Eigen::Vector3f normal(static_cast<float>(row[kNx]), static_cast<float>(row[kNy]),
                         static_cast<float>(row[kNz]));
  if (!normal.allFinite()) {
    normal.setZero();
    ++missing_normals_;
  }
  scan_.normals.push_back(normal);
}

void ScanBuilder::add_colour(const PointRow& row) {
  scan_.colours.push_back(colours_.to_bytes({row[kRed], row[kGreen], row[kBlue]}, scan_.colours));
}

void ScanBuilder::drop_colours() {
  colours_.begin(ColourRange::kNone, 0);
  scan_.colours = {};
}

void ScanBuilder::check_colours() {
  if (!has_colours()) return;
  constexpr const char* kRemedy = "export them as whole numbers, of a PCD in binary form";
  const std::uint64_t missing = colours_.missing();
  const std::uint64_t all = points_read_ - non_finite_;
  if (missing == all) {
    drop_colours();
    warn(fmt::format("{}: the colours were ignored: none of them is a number ({}).", file_,
                     kRemedy));
  } else if (missing > 0) {
    warn(fmt::format("{}: the colours of {} of {} points are not numbers and became black ({}).",
                     file_, missing, all, kRemedy));
  }
  if (colours_.is_beyond()) {
    warn(
        fmt::format("{}: some colours are above 65535, the largest value of a known range; they "
                    "became white (export the colours as 0 to 255).",
                    file_));
  }
}

void ScanBuilder::count_dropped(const std::string& cause, std::uint64_t count) {
  if (count > 0) scan_.dropped[cause] += count;
}

void ScanBuilder::set_normals(std::vector<Eigen::Vector3f> normals) {
  std::size_t next_dropped = 0;
  scan_.normals.clear();
  scan_.normals.reserve(scan_.positions.size());
  for (std::size_t i = 0; i < normals.size() && i < points_read_; ++i) {
    if (next_dropped < dropped_.size() && dropped_[next_dropped] == i) {
      ++next_dropped;
      continue;
    }
    const bool finite = normals[i].allFinite();
    if (!finite) ++missing_normals_;
    scan_.normals.push_back(finite ? normals[i] : Eigen::Vector3f::Zero());
  }
  scan_.normals.resize(scan_.positions.size(), Eigen::Vector3f::Zero());
}

void ScanBuilder::check_points_left() const {
  if (points_read_ == 0) {
    throw ReadError(file_, "", "the file contains no points",
                    "check the export, and export it again");
  }
  if (scan_.positions.empty()) {
    throw ReadError(
        file_, "",
        fmt::format("none of the {} positions is usable: all are NaN or infinite", points_read_),
        "export the scan again");
  }
}

void ScanBuilder::warn_of_damage() {
  if (non_finite_ > 0) {
    warn(fmt::format("{} of {} points were dropped: their coordinates are NaN or infinite.",
                     non_finite_, points_read_));
  }
  if (const auto lost = scan_.dropped.find(kFaceNonFinite); lost != scan_.dropped.end()) {
    warn(fmt::format("{} of {} faces were dropped with their points.", lost->second, faces_read_));
  }
  if (missing_normals_ > 0) {
    warn(fmt::format("{} points have a normal that is not a number; it is ignored.",
                     missing_normals_));
  }
  if (bad_faces_ > 0) {
    const std::string first =
        first_bad_place_ == 0 ? ""
                              : fmt::format(" (the first at {} {})", place_unit_, first_bad_place_);
    warn(
        fmt::format("{} of {} faces were dropped: they refer to points that the file does not "
                    "have, or have fewer than three distinct vertices{}.",
                    bad_faces_, faces_read_, first));
  }
}

void ScanBuilder::warn_of_more(const std::string& what, std::uint64_t declared,
                               std::uint64_t there) {
  warn(
      fmt::format("The file declares {0} {2} and holds {1}: the last {3} were left out (the "
                  "header is damaged, or two files were joined; export the scan again).",
                  declared, there, what, there - declared));
}

Scan ScanBuilder::finish(std::string format) {
  count_dropped(kNonFinite, non_finite_);
  check_points_left();
  if (thinned_ > 0) {
    thin(scan_.positions.size());  // the last points, too
    count_dropped(kBeyondMemoryLimit, thinned_);
    note_thinning();
  }
  drop_unused_poses();
  check_colours();
  check_triangles();
  cut_polygons();
  check_faces_left();
  warn_of_damage();
  scan_.format = std::move(format);
  return std::move(scan_);
}

}  // namespace tactree::builder
