#include "cleaning/stray_points.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "geometry/spacing.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kLeastPoints = 2000;
// Suspects are points with few others in the 27 cells around them (edge 1.5 to 3 spacings) ...
constexpr double kSparseCellSpacings = 1.5;
constexpr std::size_t kStrayCompany = 8;
// ... and points off the planes that explain the others of their cell (edge 2.5 to 5 spacings).
constexpr double kPlaneCellSpacings = 2.5;
constexpr std::size_t kMaxPlanes = 4;
constexpr std::size_t kLeastOnPlane = 4;
constexpr std::uint64_t kPlaneTrials = 24;
// Estimation of the noise of the scan.
constexpr std::size_t kNoiseSamples = 2000;
constexpr std::size_t kNoiseNeighbours = 12;
constexpr std::size_t kNoiseHeld = 8;  // of the neighbours, on the flattest plane
constexpr double kDeviationPerMedian = 1.5;
constexpr std::size_t kSurfaceHeld = 6;  // fewer: near an edge, the others lie on another plane
// Lower limit of the noise as a ratio of the spacing, because the surface is curved.
constexpr double kLeastNoise = 0.1;
constexpr double kLeastNoiseSparse = 0.06;
// The test of a suspect.
constexpr std::size_t kTestNeighbours = 20;
constexpr int kTrials = 32;
constexpr std::size_t kOnSurface = 9;         // neighbours required on the plane
constexpr std::size_t kAtBorder = 14;         // required where the surface ends
constexpr std::size_t kOnSparseSurface = 12;  // required where the neighbours are farther away
// Maximum angles without a neighbour inside a surface, and at a corner of its border.
constexpr double kInsideAngle = 200.0 / 180.0 * std::numbers::pi;
constexpr double kBorderAngle = 300.0 / 180.0 * std::numbers::pi;
constexpr std::size_t kCompared = 6;
// Number of the kAsked nearest neighbours that must lie on a surface through the point: to confirm
// a point inside a surface, and to keep any other point in dense or sparse surroundings.
constexpr std::size_t kAsked = 6;
constexpr std::size_t kConfirm = 1;
constexpr std::size_t kRescue = 2;
constexpr std::size_t kRescueSparse = 5;
constexpr double kTilt = 1.3;  // factor of the tolerance: a plane through few points is tilted
constexpr double kSparser = 2.2;
constexpr std::size_t kMaxPart = 8;  // at most 1/8 of the scan is dropped

struct CellPlane {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // 0: no plane

  static CellPlane through(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c) {
    return {a, (b - a).cross(c - a).normalized()};
  }
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return normal.isZero() ? std::numeric_limits<double>::infinity() : std::abs(normal.dot(p - at));
  }
};

using Triple = std::array<std::size_t, 3>;

// Numbers of three of `n` members, of which the first two differ.
Triple random_triple(std::uint64_t trial, std::size_t n) {
  const std::uint64_t random = hash64(trial);
  const std::size_t a = random % n;
  return {a, (a + 1 + (random >> 20) % (n - 1)) % n, (random >> 40) % n};
}

// The plane through three of the members that has the minimum distance to the `held` members
// nearest to it.
struct FlatPlane {
  CellPlane plane;
  double farthest = std::numeric_limits<double>::infinity();  // maximum distance of these members
};

using NoiseMembers = std::array<Eigen::Vector3d, kNoiseNeighbours>;

FlatPlane flattest_plane(const NoiseMembers& members, std::size_t held) {
  static const std::array<Triple, kPlaneTrials> kTriples = [] {
    std::array<Triple, kPlaneTrials> all{};
    for (std::uint64_t trial = 0; trial < kPlaneTrials; ++trial) {
      all[trial] = random_triple(trial, kNoiseNeighbours);
    }
    return all;
  }();
  FlatPlane flattest;
  std::array<double, kNoiseNeighbours> off{};
  for (const auto& [a, b, c] : kTriples) {
    const CellPlane plane = CellPlane::through(members[a], members[b], members[c]);
    std::size_t nearer = 0;
    for (std::size_t k = 0; k < members.size(); ++k) {
      off[k] = plane.distance(members[k]);
      nearer += off[k] < flattest.farthest ? 1U : 0U;
    }
    if (nearer >= held) {
      const auto last = off.begin() + static_cast<std::ptrdiff_t>(held - 1);
      std::nth_element(off.begin(), last, off.end());
      flattest = {plane, *last};
    }
  }
  return flattest;
}

// The test of suspects against their nearest neighbours in a cloud.
class SurfaceTest {
 public:
  SurfaceTest(const ZOrderedCloud& points, double reach, double noise, double least_noise,
              double sigma, std::size_t wanted, std::size_t wanted_at_border)
      : points_(points),
        reach_(reach),
        noise_(noise),
        least_noise_(least_noise),
        sigma_(sigma),
        wanted_(wanted),
        wanted_at_border_(wanted_at_border) {}

  // The minimum, over several planes through the point, of the widest angle, seen from the point,
  // without a neighbour on the plane. 2 pi if no plane holds enough neighbours, or if the cloud has
  // too few points.
  double narrowest_gap(std::uint32_t i, std::vector<Neighbour>& near) const {
    const Eigen::Vector3d& p = points_.positions()[i];
    points_.find_nearest(p, kTestNeighbours + 1, reach_, near);
    double narrowest = 2.0 * std::numbers::pi;
    if (near.size() <= kTestNeighbours) {
      return narrowest;
    }
    const double tolerance = sigma_ * std::max(noise_, least_noise_ * local_spacing(near));
    for (int trial = 0; trial < kTrials && narrowest > kInsideAngle; ++trial) {
      narrowest = std::min(narrowest, widest_gap(trial, p, near, tolerance));
    }
    return narrowest;
  }

  // True if at least `wanted` of the nearest neighbours lie on a common surface with the point: the
  // flattest plane through the neighbours of the neighbour passes near both.
  bool has_surfaces(std::uint32_t i, const std::vector<Neighbour>& near, std::size_t wanted) const {
    const Eigen::Vector3d& p = points_.positions()[i];
    const double tolerance = sigma_ * std::max(noise_, least_noise_ * local_spacing(near));
    std::size_t surfaces = 0;
    std::vector<Neighbour> found;
    NoiseMembers members;
    for (std::size_t k = 1; k <= kAsked && surfaces + kAsked + 1 - k >= wanted; ++k) {
      const Eigen::Vector3d& q = points_.positions()[near[k].index];
      points_.find_nearest(q, kNoiseNeighbours + 1, 0.85 * reach_, found);
      std::size_t count = 0;
      for (const Neighbour& n : found) {
        if (n.index != i && count < kNoiseNeighbours) {
          members[count++] = points_.positions()[n.index];
        }
      }
      const CellPlane plane = flattest_plane(members, kSurfaceHeld).plane;
      surfaces +=
          plane.distance(p) <= kTilt * tolerance && plane.distance(q) <= tolerance ? 1U : 0U;
      if (surfaces == wanted) {
        return true;
      }
    }
    return false;
  }

  // Compares the distance of the sixth neighbour with the median of this distance at three
  // neighbours.
  bool is_as_dense_as_others(const std::vector<Neighbour>& near) const {
    std::array<double, 3> others{};
    std::vector<Neighbour> found;
    for (std::size_t k = 0; k < others.size(); ++k) {
      points_.find_nearest(points_.positions()[near[1 + 3 * k].index], kCompared + 1, 0.65 * reach_,
                           found);
      others[k] = found.back().squared_distance;
    }
    std::sort(others.begin(), others.end());
    return near[kCompared].squared_distance <= kSparser * kSparser * others[1];
  }

 private:
  static double local_spacing(const std::vector<Neighbour>& near) {
    return std::sqrt(std::numbers::pi * near.back().squared_distance / (kTestNeighbours + 0.5));
  }

  // For the plane through the point and two neighbours: the widest angle, seen from the point,
  // without a neighbour on the plane; 2 pi if the plane holds fewer neighbours than wanted.
  double widest_gap(int trial, const Eigen::Vector3d& p, const std::vector<Neighbour>& near,
                    double tolerance) const {
    const auto random = hash64(static_cast<std::uint64_t>(trial));
    const std::size_t a = 1 + random % kTestNeighbours;
    const std::size_t b = 1 + (a + (random >> 20) % (kTestNeighbours - 1)) % kTestNeighbours;
    const Eigen::Vector3d u = (points_.positions()[near[a].index] - p).normalized();
    const Eigen::Vector3d normal = u.cross(points_.positions()[near[b].index] - p).normalized();
    const Eigen::Vector3d v = normal.cross(u);
    std::array<double, kTestNeighbours> angles{};
    std::size_t held = 0;
    for (std::size_t k = 1; k <= kTestNeighbours; ++k) {
      const Eigen::Vector3d d = points_.positions()[near[k].index] - p;
      if (std::abs(normal.dot(d)) <= tolerance) {
        angles[held++] = std::atan2(v.dot(d), u.dot(d));
      }
    }
    if (held < wanted_) {
      return 2.0 * std::numbers::pi;
    }
    std::sort(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(held));
    double widest = angles[0] + 2.0 * std::numbers::pi - angles[held - 1];
    for (std::size_t k = 1; k < held; ++k) {
      widest = std::max(widest, angles[k] - angles[k - 1]);
    }
    const bool at_border = widest > kInsideAngle;
    return at_border && held < wanted_at_border_ ? 2.0 * std::numbers::pi : widest;
  }

  const ZOrderedCloud& points_;
  double reach_;  // initial search radius for the neighbours
  double noise_;
  double least_noise_;  // in spacings of the neighbours
  double sigma_;
  std::size_t wanted_;  // required neighbours on one plane
  std::size_t wanted_at_border_;
};

class StrayFinder {
 public:
  StrayFinder(const ZOrderedCloud& points, double spacing, double sigma)
      : points_(points), spacing_(spacing), sigma_(sigma), suspect_(points.size(), 0) {}

  SurfacePoints find() {
    estimate_noise();
    suspect_sparse_cells(points_.level_for_edge(kSparseCellSpacings * spacing_));
    const std::vector<std::uint32_t> sparse = suspects();
    sparse_ = suspect_;
    suspect_off_planes();
    std::vector<std::uint8_t> stray = suspect_;
    test_sparse(sparse, stray);
    test_near(suspects(), stray);
    const auto strays = static_cast<std::size_t>(std::count(stray.begin(), stray.end(), 1));
    SurfacePoints found;
    found.undecided = strays * kMaxPart > points_.size();
    found.kept.reserve(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (found.undecided || stray[i] == 0) {
        found.kept.push_back(i);
      }
    }
    return found;
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> suspects() const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (suspect_[i] != 0) {
        found.push_back(i);
      }
    }
    return found;
  }

  // Tests sparse points that are surrounded by sparse points, against these only. The other sparse
  // points stay suspects.
  void test_sparse(const std::vector<std::uint32_t>& sparse, std::vector<std::uint8_t>& stray) {
    const ZOrderedCloud cloud = points_.subset(sparse);
    if (cloud.size() == 0) {
      return;
    }
    const SurfaceTest test(cloud, 1.5 * coarse_cell_edge(cloud), noise_, kLeastNoiseSparse, sigma_,
                           kOnSparseSurface, kOnSparseSurface);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count32(cloud), 64), [&](auto range) {
      std::vector<Neighbour> near;
      for (std::uint32_t s = range.begin(); s < range.end(); ++s) {
        points_.find_nearest(points_.positions()[sparse[s]], kTestNeighbours + 1, 6.0 * spacing_,
                             near);
        const auto others = std::count_if(
            near.begin(), near.end(), [&](const Neighbour& n) { return sparse_[n.index] != 0; });
        if (static_cast<std::size_t>(others) > kTestNeighbours / 4) {
          stray[sparse[s]] = test.narrowest_gap(s, near) > kBorderAngle ? 1 : 0;
          suspect_[sparse[s]] = 0;
        }
      }
    });
  }

  void test_near(const std::vector<std::uint32_t>& suspects, std::vector<std::uint8_t>& stray) {
    const double noise = std::max(noise_, kLeastNoise * spacing_);
    const SurfaceTest test(points_, 3.0 * spacing_, noise, kLeastNoise, sigma_, kOnSurface,
                           kAtBorder);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, suspects.size(), 64), [&](auto range) {
      std::vector<Neighbour> near;
      for (std::size_t s = range.begin(); s < range.end(); ++s) {
        const double gap = test.narrowest_gap(suspects[s], near);
        const std::size_t wanted = surfaces_wanted(test, gap, near);
        stray[suspects[s]] = test.has_surfaces(suspects[s], near, wanted) ? 0 : 1;
      }
    });
  }

  static std::size_t surfaces_wanted(const SurfaceTest& test, double gap,
                                     const std::vector<Neighbour>& near) {
    if (gap <= kInsideAngle) {
      return kConfirm;
    }
    if (!test.is_as_dense_as_others(near)) {
      return kRescueSparse;
    }
    return gap <= kBorderAngle ? kConfirm : kRescue;
  }

  static std::uint32_t count32(const ZOrderedCloud& cloud) {
    return static_cast<std::uint32_t>(cloud.size());
  }

  void suspect_sparse_cells(int level) {
    const std::vector<CellRange> cells = points_.cells(level);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 256), [&](auto range) {
      for (std::size_t c = range.begin(); c < range.end(); ++c) {
        if (cells[c].count() <= kStrayCompany && count_around(cells[c], level) <= kStrayCompany) {
          std::fill(suspect_.begin() + cells[c].first, suspect_.begin() + cells[c].last, 1);
        }
      }
    });
  }

  [[nodiscard]] std::size_t count_around(const CellRange& range, int level) const {
    const Eigen::Vector3i cell = points_.cell_of(range.first, level);
    const int cells = 1 << level;
    std::size_t count = range.count();
    for (int k = 0; k < 27 && count <= kStrayCompany; ++k) {
      const Eigen::Vector3i at = cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (k != 13 && (at.array() >= 0).all() && (at.array() < cells).all()) {
        count += points_.find(at, level).count();
      }
    }
    return count;
  }

  // Suspects the points of a cell that lie on none of a few planes through most of its points.
  void suspect_off_planes() {
    const std::vector<CellRange> cells =
        points_.cells(points_.level_for_edge(kPlaneCellSpacings * spacing_));
    const double tolerance = sigma_ * std::max(noise_, kLeastNoise * spacing_);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 256), [&](auto range) {
      std::vector<std::uint32_t> left;
      for (std::size_t c = range.begin(); c < range.end(); ++c) {
        left.clear();
        for (std::uint32_t i = cells[c].first; i < cells[c].last; ++i) {
          left.push_back(i);
        }
        explain(left, tolerance);
        for (const std::uint32_t i : left) {
          suspect_[i] = 1;
        }
      }
    });
  }

  // Removes from `left` the points on planes that hold many of them.
  void explain(std::vector<std::uint32_t>& left, double tolerance) const {
    const std::size_t least = std::max(kLeastOnPlane, left.size() / kMaxPlanes / 2);
    for (std::size_t plane = 0; plane < kMaxPlanes && left.size() >= least; ++plane) {
      const CellPlane best = plane_with_most(left, tolerance);
      const auto end = std::remove_if(left.begin(), left.end(), [&](std::uint32_t i) {
        return best.distance(points_.positions()[i]) <= tolerance;
      });
      if (static_cast<std::size_t>(left.end() - end) < least) {
        return;
      }
      left.erase(end, left.end());
    }
  }

  // Of the planes through some triples of the points, returns the one with the maximum number of
  // points near it.
  [[nodiscard]] CellPlane plane_with_most(const std::vector<std::uint32_t>& members,
                                          double tolerance) const {
    CellPlane best;
    std::size_t most = 0;
    for (std::uint64_t trial = 0; trial < kPlaneTrials && 10 * most < 9 * members.size(); ++trial) {
      const auto [a, b, c] = random_triple(trial, members.size());
      const std::vector<Eigen::Vector3d>& p = points_.positions();
      const CellPlane plane = CellPlane::through(p[members[a]], p[members[b]], p[members[c]]);
      const auto held = static_cast<std::size_t>(std::count_if(
          members.begin(), members.end(),
          [&](std::uint32_t i) { return plane.distance(points_.positions()[i]) <= tolerance; }));
      if (held > most) {
        most = held;
        best = plane;
      }
    }
    return best;
  }

  // Estimates the noise: the median, over a sample of the points, of the deviation from the
  // flattest plane through their neighbours.
  void estimate_noise() {
    const std::size_t stride = 1 + points_.size() / kNoiseSamples;
    std::vector<double> noise((points_.size() + stride - 1) / stride);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, noise.size(), 64), [&](auto range) {
      std::vector<Neighbour> near;
      NoiseMembers members;
      for (std::size_t s = range.begin(); s < range.end(); ++s) {
        points_.find_nearest(points_.positions()[s * stride], kNoiseNeighbours, 2.0 * spacing_,
                             near);
        std::transform(near.begin(), near.end(), members.begin(),
                       [&](const Neighbour& n) { return points_.positions()[n.index]; });
        noise[s] = kDeviationPerMedian * flattest_plane(members, kNoiseHeld).farthest;
      }
    });
    const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
    std::nth_element(noise.begin(), middle, noise.end());
    noise_ = *middle;
  }

  const ZOrderedCloud& points_;
  double spacing_;
  double sigma_;
  double noise_ = 0.0;
  std::vector<std::uint8_t> suspect_;
  std::vector<std::uint8_t> sparse_;  // suspects with few points around them
};

}  // namespace

SurfacePoints points_on_surfaces(const ZOrderedCloud& points, double spacing, double sigma) {
  if (points.size() < kLeastPoints) {
    SurfacePoints all;
    all.kept.resize(points.size());
    std::iota(all.kept.begin(), all.kept.end(), 0U);
    return all;
  }
  return StrayFinder(points, spacing, sigma).find();
}

}  // namespace tactree::builder
