#include "normals/given_normals.hpp"

#include <cmath>

namespace tactree::builder {
namespace {

constexpr std::size_t kPointsCompared = 4096;
constexpr std::size_t kNeighboursCompared = 6;
constexpr float kParallel = 0.8F;  // |cosine| of normals that can be compared
constexpr double kMaxOpposed = 0.25;

}  // namespace

bool signs_are_random(const ZOrderedCloud& points, double spacing) {
  if (!points.cloud().has_normals()) {
    return false;
  }
  std::size_t compared = 0;
  std::size_t opposed = 0;
  std::vector<Neighbour> found;
  const std::size_t stride = 1 + points.size() / kPointsCompared;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    points.find_nearest(points.positions()[i], kNeighboursCompared + 1, 1.5 * spacing, found);
    for (const Neighbour& n : found) {
      const float cosine = points.normals()[i].dot(points.normals()[n.index]);
      if (n.index != i && std::abs(cosine) > kParallel) {
        ++compared;
        opposed += cosine < 0.0F ? 1U : 0U;
      }
    }
  }
  return static_cast<double>(opposed) > kMaxOpposed * static_cast<double>(compared);
}

}  // namespace tactree::builder
