#include "cleaning/scanner_poses.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/cloud.hpp"
#include "geometry/morton.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kPointsCompared = 200'000;
constexpr int kFinestLevel = 14;  // cells per edge of a face of the cube of directions: 2^level
constexpr std::size_t kPointsPerCell = 8;
constexpr std::size_t kLeastInCell = 4;
constexpr double kBehind = 1.5;  // gap in range between points in front and behind, in cell widths
// Maximum ratio of hidden points. From the real position only a few points at silhouettes are
// hidden; from another position, about half the points of a closed body.
constexpr double kMaxHidden = 0.25;
// Maximum ratio of densities. The pixels of a scanner cover equal solid angles within a factor of
// two; from another position, steep parts of the surface appear denser.
constexpr double kMaxUnevenness = 6.0;
// In diagonals of the bounding box.
constexpr double kMaxRange = 30.0;

struct Ray {
  std::uint64_t cell;  // face of the cube of directions, followed by the Morton code on it
  double range;
};

Ray ray_to(const Eigen::Vector3d& from_viewpoint) {
  Eigen::Index axis = 0;
  const double most = from_viewpoint.cwiseAbs().maxCoeff(&axis);
  const bool negative = from_viewpoint[axis] < 0.0;
  const double scale = most > 0.0 ? 0.5 / most : 0.0;
  const auto at = [&](Eigen::Index k) {
    constexpr double kCells = 1 << kFinestLevel;
    const double u = 0.5 + scale * from_viewpoint[(axis + k) % 3];
    return std::clamp(static_cast<int>(u * kCells), 0, (1 << kFinestLevel) - 1);
  };
  const auto face = static_cast<std::uint64_t>(2 * axis + (negative ? 1 : 0));
  const std::uint64_t code = morton_code(Eigen::Vector3i(at(1), at(2), 0));
  return {face << (3 * kFinestLevel) | code, from_viewpoint.norm()};
}

std::size_t cells_at(const std::vector<Ray>& rays, int level) {
  const int shift = 3 * (kFinestLevel - level);
  std::size_t cells = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    cells += i == 0 || rays[i].cell >> shift != rays[i - 1].cell >> shift ? 1U : 0U;
  }
  return cells;
}

// Number of points of a cell behind its widest gap in range, if this gap is wide. Sorts by range.
std::size_t behind(std::span<Ray> cell, double width) {
  std::sort(cell.begin(), cell.end(), [](const Ray& a, const Ray& b) { return a.range < b.range; });
  std::size_t first_behind = cell.size();
  double widest = kBehind * width * cell.front().range;
  for (std::size_t i = 1; i < cell.size(); ++i) {
    const double gap = cell[i].range - cell[i - 1].range;
    if (gap > widest) {
      widest = gap;
      first_behind = i;
    }
  }
  return cell.size() - first_behind;
}

}  // namespace

Appearance appearance_from(const Eigen::Vector3d& viewpoint,
                           std::span<const Eigen::Vector3d> positions) {
  std::vector<Ray> rays;
  Box box;
  const std::size_t stride = 1 + positions.size() / kPointsCompared;
  for (std::size_t i = 0; i < positions.size(); i += stride) {
    rays.push_back(ray_to(positions[i] - viewpoint));
    box.extend(positions[i]);
  }
  std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.range < b.range;
  });
  int level = kFinestLevel;
  while (level > 0 && cells_at(rays, level) * kPointsPerCell > rays.size()) {
    --level;
  }
  const int shift = 3 * (kFinestLevel - level);
  const double width = std::ldexp(2.0, -level);
  std::size_t tested = 0;
  std::size_t hidden = 0;
  std::vector<std::size_t> counts;
  for (std::size_t first = 0, last = 0; first < rays.size(); first = last) {
    while (last < rays.size() && rays[last].cell >> shift == rays[first].cell >> shift) {
      ++last;
    }
    counts.push_back(last - first);
    if (last - first >= kLeastInCell) {
      tested += last - first;
      hidden += behind(std::span(rays).subspan(first, last - first), width);
    }
  }
  std::sort(counts.begin(), counts.end());
  const auto part = [&](std::size_t tenths) {
    return static_cast<double>(counts[tenths * (counts.size() - 1) / 10]);
  };
  return tested == 0 ? Appearance{}
                     : Appearance{static_cast<double>(hidden) / static_cast<double>(tested),
                                  part(9) / part(1),
                                  (box.center() - viewpoint).norm() / box.diagonal().norm()};
}

void check_poses(Scan& scan, BuildReport& report) {
  double most_hidden = 0.0;
  for (std::size_t k = 0; k < scan.poses.size(); ++k) {
    ScannerPose& pose = scan.poses[k];
    const std::size_t last =
        k + 1 < scan.poses.size() ? scan.poses[k + 1].first_point : scan.positions.size();
    const Appearance seen = appearance_from(
        pose.position,
        std::span(scan.positions).subspan(pose.first_point, last - pose.first_point));
    if (seen.hidden <= kMaxHidden &&
        (pose.sure || (seen.unevenness <= kMaxUnevenness && seen.range <= kMaxRange))) {
      report.orientation.scanners.push_back(pose.position);
    } else {
      most_hidden = std::max(most_hidden, pose.sure ? seen.hidden : 0.0);
      pose.position.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  if (most_hidden > 0.0) {
    report.warnings.push_back(fmt::format(
        "the position of the scanner in the file was ignored: {:.0f} % of the points are hidden "
        "from there (give --viewpoint X,Y,Z)",
        100.0 * most_hidden));
  }
}

}  // namespace tactree::builder
