#include "orientation_score.hpp"

#include <limits>
#include <stdexcept>
#include <unordered_map>

#include "tactree/core/model/blob.hpp"

namespace tactree::bench {
namespace {

// Finds the nearest point of a cloud within one spacing.
class Nearest {
 public:
  Nearest(const std::vector<Eigen::Vector3d>& positions, double edge)
      : positions_(positions), edge_(edge) {
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      cells_.emplace(key(positions[i]), i);
    }
  }
  static constexpr std::uint32_t kNone = ~0U;
  [[nodiscard]] std::uint32_t find(const Eigen::Vector3d& at) const {
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = kNone;
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3d cell =
          at + edge_ * Eigen::Vector3d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      auto [it, end] = cells_.equal_range(key(cell));
      for (; it != end; ++it) {
        const double squared = (positions_[it->second] - at).squaredNorm();
        if (squared < best || (squared == best && it->second < nearest)) {
          best = squared;
          nearest = it->second;
        }
      }
    }
    return nearest;
  }

 private:
  [[nodiscard]] std::uint64_t key(const Eigen::Vector3d& p) const {
    const Eigen::Vector3i cell = (p / edge_).array().floor().cast<int>() + (1 << 20);
    return static_cast<std::uint64_t>(cell.x()) | static_cast<std::uint64_t>(cell.y()) << 21 |
           static_cast<std::uint64_t>(cell.z()) << 42;
  }
  const std::vector<Eigen::Vector3d>& positions_;
  double edge_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

}  // namespace

builder::Scan scan_of(const KnownCloud& cloud) {
  builder::Scan scan;
  for (const Eigen::Vector3d& p : cloud.positions) {
    scan.positions.push_back(kUnit_m * p);
  }
  return scan;
}

double wrong_share(const KnownCloud& cloud, const builder::BuildResult& built) {
  std::vector<Eigen::Vector3d> placed;
  for (const Eigen::Vector3d& p : cloud.positions) {
    placed.push_back(kUnit_m * p - built.report.source_origin);
  }
  const Nearest nearest(placed, built.report.spacing_m);
  core::BlobView view;
  if (core::open_blob(built.blob.bytes, view) != core::BlobStatus::kOk) {
    throw std::logic_error("the blob is not valid");
  }
  std::size_t wrong = 0;
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::Vec3 p = view.position(leaf, index);
    const core::Vec3 n = view.normal(index);
    const std::uint32_t at = nearest.find(Eigen::Vector3f(p.x, p.y, p.z).cast<double>());
    const bool right = at != Nearest::kNone &&
                       cloud.normals[at].dot(Eigen::Vector3f(n.x, n.y, n.z).cast<double>()) > 0.0;
    wrong += right ? 0 : 1;
  });
  return static_cast<double>(wrong) / static_cast<double>(view.point_count());
}

}  // namespace tactree::bench
