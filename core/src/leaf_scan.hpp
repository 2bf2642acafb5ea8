#pragma once
// Distances from a probe to the points of one leaf, in the leaf's own frame: there the probe's
// coordinates are small, so float32 keeps them to about 1e-7 of a leaf edge.

#include "tactree/core/blob.hpp"

namespace tactree::core {

class LeafScan {
 public:
  LeafScan(const BlobView& view, const Leaf& leaf, Vec3 probe)
      : words_(view.point_words()),
        scale_(view.step_m() * static_cast<float>(2U << (view.depth() - leaf.level))),
        local_{local(view, leaf, probe.x, leaf.min.x), local(view, leaf, probe.y, leaf.min.y),
               local(view, leaf, probe.z, leaf.min.z)} {}

  /// From the point to the probe, m.
  [[nodiscard]] Vec3 offset(std::uint32_t index) const {
    const std::uint32_t word = words_[index];
    return {local_.x - scale_ * coordinate(word >> 29, word >> 2),
            local_.y - scale_ * coordinate(word >> 30, word >> 11),
            local_.z - scale_ * coordinate(word >> 31, word >> 20)};
  }

  /// Squared distance from the probe to the cube around the leaf's sites, m^2; not rounded up.
  [[nodiscard]] float distance_squared_to_cube() const {
    const float edge = scale_ * static_cast<float>(kLeafUnits / 2 - 1);
    const Vec3 outside{beyond(local_.x, edge), beyond(local_.y, edge), beyond(local_.z, edge)};
    return 0.999999F * length_squared(outside);
  }

 private:
  // Counted from the leaf's first site, so that a site's coordinate is scale * 0 ... 1023.
  static float local(const BlobView& view, const Leaf& leaf, float v, std::int32_t low) {
    const std::int32_t first_site = low + (1 << (view.depth() - leaf.level));
    return v - view.step_m() * static_cast<float>(first_site);
  }
  static float coordinate(std::uint32_t octant, std::uint32_t rest) {
    return static_cast<float>(static_cast<std::int32_t>((octant & 1U) << 9 | (rest & 511U)));
  }
  static float beyond(float v, float edge) {
    if (v < 0.0F) return -v;
    return v > edge ? v - edge : 0.0F;
  }

  const std::uint32_t* words_;
  float scale_;
  Vec3 local_;
};

/// Does the axis-aligned box, half-width `half`, of any of the leaf's points hold the probe?
inline bool leaf_has_box_around(const BlobView& view, const Leaf& leaf, Vec3 probe, float half) {
  const LeafScan scan(view, leaf, probe);
  const std::uint32_t end = leaf.first_point + leaf.point_count;
  for (std::uint32_t p = leaf.first_point; p < end; ++p) {  // bound: points_per_leaf
    const Vec3 d = scan.offset(p);
    if (absolute(d.x) <= half && absolute(d.y) <= half && absolute(d.z) <= half) {
      return true;
    }
  }
  return false;
}

}  // namespace tactree::core
