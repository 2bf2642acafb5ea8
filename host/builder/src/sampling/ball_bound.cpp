#include "sampling/ball_bound.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "geometry/morton.hpp"
#include "geometry/point_grid.hpp"

namespace tactree::builder {
namespace {

// Cubes of centres are halved from an edge of 2 r down to r / 32. The last edge adds 4 % of points
// to a ball on a surface.
constexpr double kCubeRadii = 2.0;
constexpr std::uint32_t kLevels = 6;
// A cube is pruned if its bound is within this factor of a count that occurs. A factor near 1 saves
// scratch memory and cycles on the board but requires more cubes here. 1.05 takes 1.6 times as long
// as 1.1.
constexpr double kTolerance = 1.05;
constexpr double kToleranceOfLarge = 1.2;
constexpr std::size_t kLargeModel = 200000;  // points; more than most boards can store
constexpr std::size_t kSamples = 200000;
// Exceeds the rounding of a float32 distance between points a few r apart (below 1e-6).
constexpr float kRadiusMargin = 1.0F + 4e-6F;

// A cube of centres; lengths in units of the ball's radius.
struct Cube {
  Eigen::Vector3f centre;
  float edge;

  [[nodiscard]] float half_edge() const { return 0.5F * edge; }
  [[nodiscard]] float half_diagonal() const { return 0.8660255F * edge; }
  [[nodiscard]] Cube octant(unsigned which) const {
    const float quarter = 0.25F * edge;
    return {centre + Eigen::Vector3f((which & 1U) != 0 ? quarter : -quarter,
                                     (which & 2U) != 0 ? quarter : -quarter,
                                     (which & 4U) != 0 ? quarter : -quarter),
            0.5F * edge};
  }
};

std::uint32_t tolerated(std::uint32_t count, double tolerance) {
  return std::max(count, static_cast<std::uint32_t>(tolerance * count));
}

std::uint32_t count_within(std::span<const Eigen::Vector3d> positions, const PointGrid& grid,
                           const Eigen::Vector3d& centre, double radius) {
  std::uint32_t count = 0;
  grid.visit_near(centre, radius, [&](std::uint32_t i) {
    count += (positions[i] - centre).squaredNorm() <= radius * radius ? 1U : 0U;
  });
  return count;
}

// A count that occurs: the maximum over the balls around the points (around a regular sample of
// them).
std::uint32_t occurring_maximum(std::span<const Eigen::Vector3d> positions, const PointGrid& grid,
                                double radius) {
  const std::size_t stride = 1 + positions.size() / kSamples;
  const std::size_t samples = (positions.size() + stride - 1) / stride;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, samples, 256), 0U,
      [&](const tbb::blocked_range<std::size_t>& range, std::uint32_t best) {
        for (std::size_t s = range.begin(); s < range.end(); ++s) {
          const Eigen::Vector3d& centre = positions[grid.order()[s * stride]];
          best = std::max(best, count_within(positions, grid, centre, radius));
        }
        return best;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

void sort_unique(std::vector<std::uint64_t>& codes) {
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
}

// The cells whose cubes of centres cover every ball that holds a point: the cells of the grid (edge
// at least 2 r) that are occupied or adjacent to an occupied one. Each is listed once, in a fixed
// order.
std::vector<Eigen::Vector3i> cells_of_centres(const PointGrid& grid) {
  const Eigen::Vector3i shift = Eigen::Vector3i::Constant(1);  // keeps coordinates positive
  std::vector<std::uint64_t> codes;
  std::size_t tidy_at = std::size_t{1} << 22;
  for (std::size_t cell = 0; cell < grid.cell_count(); ++cell) {
    const Eigen::Vector3i at = grid.cell_coordinates(cell) + shift;
    for (int k = 0; k < 27; ++k) {
      codes.push_back(morton_code(at + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
    }
    if (codes.size() > tidy_at) {
      sort_unique(codes);
      tidy_at = std::max(tidy_at, 2 * codes.size());
    }
  }
  sort_unique(codes);
  std::vector<Eigen::Vector3i> cells;
  cells.reserve(codes.size());
  for (const std::uint64_t code : codes) {
    cells.push_back(morton_cell(code) - shift);
  }
  return cells;
}

// SIMD vectors of four floats or integers.
using Floats = float __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));

// Points relative to the centre of a cube of the grid, compared four at a time.
class Candidates {
 public:
  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] std::uint32_t index(std::uint32_t i) const { return index_[i]; }
  [[nodiscard]] Eigen::Vector3f position(std::uint32_t i) const { return {x_[i], y_[i], z_[i]}; }

  void clear() { size_ = 0; }
  void add(const Eigen::Vector3f& position, std::uint32_t index) {
    make_room(size_ + 1);
    x_[size_] = position.x();
    y_[size_] = position.y();
    z_[size_] = position.z();
    index_[size_++] = index;
  }
  // Fills the last group of four. Required between add() and any comparison.
  void finish() {
    make_room(size_);
    for (std::uint32_t i = size_; i % 4 != 0; ++i) {
      x_[i] = y_[i] = z_[i] = kAway;
    }
  }

  // Number of points within a distance of 1 from the cube centre +- half_edge.
  [[nodiscard]] std::uint32_t count_near(const Eigen::Vector3f& centre, float half_edge) const {
    Integers count = {0, 0, 0, 0};
    for (std::uint32_t i = 0; i < size_; i += 4) {
      count -= near(i, centre, half_edge);  // true is -1
    }
    return static_cast<std::uint32_t>(count[0] + count[1] + count[2] + count[3]);
  }
  // Replaces `found` by these points.
  void filter(const Eigen::Vector3f& centre, float half_edge, Candidates& found) const {
    found.make_room(size_);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size_; i += 4) {
      const Integers is_near = near(i, centre, half_edge);
      for (std::uint32_t lane = 0; lane < 4; ++lane) {
        // Without a branch: the next point overwrites one that is not near.
        found.x_[count] = x_[i + lane];
        found.y_[count] = y_[i + lane];
        found.z_[count] = z_[i + lane];
        found.index_[count] = index_[i + lane];
        count -= static_cast<std::uint32_t>(is_near[lane]);
      }
    }
    found.size_ = count;
    found.finish();
  }
  // True if all points lie beyond the plane at the distance `margin` from `centre` towards their
  // mean.
  [[nodiscard]] bool all_to_one_side(const Eigen::Vector3f& centre, float margin) const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::uint32_t i = 0; i < size_; ++i) {
      sum += position(i) - centre;
    }
    const float length = sum.norm();
    if (!(length > margin)) {
      return false;
    }
    const Eigen::Vector3f direction = sum / length;
    for (std::uint32_t i = 0; i < size_; ++i) {
      if ((position(i) - centre).dot(direction) <= margin) {
        return false;
      }
    }
    return true;
  }

 private:
  static constexpr float kAway = 1e30F;  // its square is infinite, so it is within no radius

  // For `count` points, the rest of the last group, and one that filter() overwrites.
  void make_room(std::uint32_t count) {
    if (x_.size() < count + 4) {
      const std::size_t room = 2 * (std::size_t{count} + 4);
      x_.resize(room);
      y_.resize(room);
      z_.resize(room);
      index_.resize(room);
    }
  }

  // Distance of the coordinates from the interval centre +- half_edge; 0 inside.
  static Floats beyond(const float* coordinates, float centre, float half_edge) {
    Floats offset;
    std::memcpy(&offset, coordinates, sizeof offset);
    offset -= centre;
    const Integers magnitude = std::bit_cast<Integers>(offset) & 0x7FFFFFFF;
    const Floats distance = std::bit_cast<Floats>(magnitude) - half_edge;
    const Integers positive =
        std::bit_cast<Integers>(distance) & (distance > Floats{0.0F, 0.0F, 0.0F, 0.0F});
    return std::bit_cast<Floats>(positive);
  }
  [[nodiscard]] Integers near(std::uint32_t i, const Eigen::Vector3f& centre,
                              float half_edge) const {
    const Floats x = beyond(&x_[i], centre.x(), half_edge);
    const Floats y = beyond(&y_[i], centre.y(), half_edge);
    const Floats z = beyond(&z_[i], centre.z(), half_edge);
    return x * x + y * y + z * z <= kRadiusMargin * kRadiusMargin;
  }

  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> z_;
  std::vector<std::uint32_t> index_;
  std::uint32_t size_ = 0;
};

// The points that a ball around any centre in a cube can hold: one list per level, filtered from
// the level above. Lengths are in units of the radius, relative to the centre of the cube gathered
// last.
class CandidateLists {
 public:
  CandidateLists(std::span<const Eigen::Vector3d> positions, const PointGrid& grid, double radius)
      : positions_(positions), grid_(grid), radius_(radius) {}

  [[nodiscard]] const Candidates& at(std::uint32_t level) const { return lists_[level]; }

  Cube gather(const Eigen::Vector3i& cell) {
    const Eigen::Vector3d centre = grid_.cell_centre(cell);
    const Cube cube{Eigen::Vector3f::Zero(), static_cast<float>(grid_.cell_edge() / radius_)};
    const double reach = radius_ + 0.50001 * grid_.cell_edge();
    gathered_.clear();
    grid_.visit_near(centre, reach, [&](std::uint32_t i) {
      const Eigen::Vector3d offset = positions_[i] - centre;
      if (offset.cwiseAbs().maxCoeff() <= reach) {
        gathered_.add((offset / radius_).cast<float>(), i);
      }
    });
    gathered_.finish();
    gathered_.filter(cube.centre, cube.half_edge(), lists_[0]);
    return cube;
  }
  void filter(const Cube& cube, std::uint32_t level) {
    lists_[level - 1].filter(cube.centre, cube.half_edge(), lists_[level]);
  }

 private:
  std::span<const Eigen::Vector3d> positions_;
  const PointGrid& grid_;
  double radius_;
  Candidates gathered_;
  std::array<Candidates, kLevels + 1> lists_;
};

// Bounds the balls centred in one cube of the grid, depth first.
class BoundSearch {
 public:
  BoundSearch(CandidateLists lists, double tolerance)
      : lists_(std::move(lists)), tolerance_(tolerance) {}

  // Returns an upper bound for the cell. Cubes with a bound of at most `enough` are pruned.
  std::uint32_t bound(const Eigen::Vector3i& cell, std::uint32_t enough) {
    enough_ = enough;
    const Cube cube = lists_.gather(cell);
    return lists_.at(0).size() <= enough ? lists_.at(0).size() : descend(cube, 0);
  }

 private:
  // Precondition: the list of `level` belongs to the cube.
  // NOLINTNEXTLINE(misc-no-recursion): at most kLevels deep
  std::uint32_t descend(const Cube& cube, std::uint32_t level) {
    const Candidates& all = lists_.at(level);
    if (level == kLevels) {
      return all.size();
    }
    // The smallest ball around a set of points has its centre in their convex hull. A cube whose
    // points all lie on one side of it therefore cannot contain that centre.
    if (all.all_to_one_side(cube.centre, kRadiusMargin * cube.half_diagonal())) {
      return 0;
    }
    std::uint32_t best = 0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      const Cube child = cube.octant(octant);
      std::uint32_t count = all.count_near(child.centre, child.half_edge());
      if (count > enough_) {
        enough_ = std::max(enough_, tolerated(all.count_near(child.centre, 0.0F), tolerance_));
      }
      if (count > enough_) {
        lists_.filter(child, level + 1);
        count = descend(child, level + 1);
      }
      best = std::max(best, count);
    }
    return best;
  }

  CandidateLists lists_;
  double tolerance_;
  std::uint32_t enough_ = 0;
};

// Drops points until no ball centred in a cube holds too many. One pass over all cubes suffices,
// because dropping never raises a count.
class Thinner {
 public:
  Thinner(CandidateLists lists, std::span<const std::uint64_t> rank, std::uint32_t most)
      : lists_(std::move(lists)), rank_(rank), most_(most), kept_(rank.size(), true) {}

  void thin(const Eigen::Vector3i& cell) { descend(lists_.gather(cell), 0); }
  [[nodiscard]] std::vector<bool> take() { return std::move(kept_); }

 private:
  // NOLINTNEXTLINE(misc-no-recursion): at most kLevels deep
  void descend(const Cube& cube, std::uint32_t level) {
    const std::vector<std::uint32_t> inside = kept_of(lists_.at(level));
    if (inside.size() <= most_) {
      return;
    }
    if (level == kLevels) {
      drop_lowest(inside);
      return;
    }
    for (unsigned octant = 0; octant < 8; ++octant) {
      const Cube child = cube.octant(octant);
      lists_.filter(child, level + 1);
      descend(child, level + 1);
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> kept_of(const Candidates& candidates) const {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
      if (kept_[candidates.index(i)]) {
        kept.push_back(candidates.index(i));
      }
    }
    return kept;
  }

  void drop_lowest(std::vector<std::uint32_t> inside) {
    std::sort(inside.begin(), inside.end(), [&](std::uint32_t a, std::uint32_t b) {
      return rank_[a] != rank_[b] ? rank_[a] > rank_[b] : a < b;
    });
    for (std::size_t k = most_; k < inside.size(); ++k) {
      kept_[inside[k]] = false;
    }
  }

  CandidateLists lists_;
  std::span<const std::uint64_t> rank_;
  std::uint32_t most_;
  std::vector<bool> kept_;
};

}  // namespace

std::uint32_t max_points_in_ball(std::span<const Eigen::Vector3d> positions, double radius) {
  if (positions.empty()) {
    return 0;
  }
  const PointGrid grid(positions, kCubeRadii * radius);
  const std::uint32_t occurring = occurring_maximum(positions, grid, radius);
  const double tolerance = positions.size() > kLargeModel ? kToleranceOfLarge : kTolerance;
  const std::uint32_t enough = tolerated(occurring, tolerance);
  const std::vector<Eigen::Vector3i> cells = cells_of_centres(grid);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, cells.size(), 64), occurring,
      [&](const tbb::blocked_range<std::size_t>& range, std::uint32_t best) {
        BoundSearch search(CandidateLists(positions, grid, radius), tolerance);
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          best = std::max(best, search.bound(cells[i], enough));
        }
        return best;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

std::vector<bool> thin_to_ball_bound(std::span<const Eigen::Vector3d> positions,
                                     std::span<const std::uint64_t> rank, double radius,
                                     std::uint32_t most) {
  const PointGrid grid(positions, kCubeRadii * radius);
  const std::vector<Eigen::Vector3i> cells = cells_of_centres(grid);
  // Most cells need no thinning. The others are identified first, in parallel.
  std::vector<std::uint8_t> crowded(cells.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 64), [&](auto range) {
    BoundSearch search(CandidateLists(positions, grid, radius), 1.0);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      crowded[i] = search.bound(cells[i], most) > most ? 1 : 0;
    }
  });
  Thinner thinner(CandidateLists(positions, grid, radius), rank, most);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (crowded[i] != 0) {
      thinner.thin(cells[i]);
    }
  }
  return thinner.take();
}

}  // namespace tactree::builder
