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
    return {local_.x - scale_ * coordinate((word >> 2) & 1023U),
            local_.y - scale_ * coordinate((word >> 12) & 1023U),
            local_.z - scale_ * coordinate(word >> 22)};
  }

  /// Squared distances of kLanes consecutive points, m^2; a fixed count, which compilers turn into
  /// vector code where the core has any. Each lane rounds as length_squared(offset()) does.
  static constexpr std::uint32_t kLanes = 8;
  void distances_squared(std::uint32_t first, float (&squared)[kLanes]) const {
    const std::uint32_t* const words = words_ + first;
    for (std::uint32_t k = 0; k < kLanes; ++k) {  // bound: 8
      const std::uint32_t word = words[k];
      const float x = local_.x - scale_ * coordinate((word >> 2) & 1023U);
      const float y = local_.y - scale_ * coordinate((word >> 12) & 1023U);
      const float z = local_.z - scale_ * coordinate(word >> 22);
      squared[k] = x * x + y * y + z * z;
    }
  }

 private:
  // Counted from the leaf's first site, so that a site's coordinate is scale * 0 ... 1023.
  static float local(const BlobView& view, const Leaf& leaf, float v, std::int32_t low) {
    const std::int32_t first_site = low + (1 << (view.depth() - leaf.level));
    return v - view.step_m() * static_cast<float>(first_site);
  }
  static float coordinate(std::uint32_t site) {
    return static_cast<float>(static_cast<std::int32_t>(site));
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
