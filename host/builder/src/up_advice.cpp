#include "tactree/builder/up_advice.hpp"

#include <fmt/core.h>

#include <vector>

#include "tactree/builder/openings.hpp"
#include "tactree/core/model/interior.hpp"
#include "up_hint.hpp"

namespace tactree::builder {
namespace {

// Of a larger model the openings take longer to find than the page to load.
constexpr std::size_t kMaxPointsForOpenings = 1'000'000;

}  // namespace

std::optional<std::string> up_advice(const core::BlobView& view) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;
  std::size_t backed = 0;
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint point = view.surface_point(leaf, index);
    const core::Vec3 p = point.position;
    positions.emplace_back(Eigen::Vector3f(p.x, p.y, p.z).cast<double>());
    normals.emplace_back(point.normal.x, point.normal.y, point.normal.z);
    backed += index == leaf.first_point && core::interior_at(view, p).behind ? leaf.point_count : 0;
  });
  const auto least = kBodyShare * static_cast<double>(positions.size());
  const std::vector<Opening> openings =
      positions.size() <= kMaxPointsForOpenings ? find_openings(view) : std::vector<Opening>();
  const auto posture =
      lying_posture(positions, normals, openings, static_cast<double>(view.header().spacing_m),
                    static_cast<double>(backed) < least);
  if (!posture || posture->evidence == UpEvidence::kLongest) {
    return std::nullopt;
  }
  return fmt::format("{} (build --axis {} turns a model that was built without --axis)",
                     describe_lying(*posture), letter_of(posture->up));
}

}  // namespace tactree::builder
