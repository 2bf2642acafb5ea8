#pragma once
// Distances from a probe to the points of one leaf, computed in the frame of the leaf, where
// coordinates are small and float32 resolves about 1e-7 of a leaf edge.
// Loop and memory annotations: docs/BOUND.md.

#include "corner_leaves.hpp"
#include "lanes.hpp"

namespace tactree::core {

class LeafScan {
 public:
  LeafScan(const BlobView& view, const NearLeaf& leaf)
      : words_(view.point_words()),
        first_(leaf.first_point),
        end_(leaf.end_point),
        scale_(leaf.site_m),
        local_(leaf.local) {}

  /// Vector from the point to the probe, m.
  [[nodiscard]] Vec3 offset(std::uint32_t index) const {
    const std::uint32_t word = words_[index];
    return {local_.x - scale_ * coordinate((word >> 2) & 1023U),
            local_.y - scale_ * coordinate((word >> 12) & 1023U),
            local_.z - scale_ * coordinate(word >> 22)};
  }

  /// Calls visit(squared, index) for kLanes points at a time; squared distances in m^2. Indices
  /// ascend in each lane. Some of the last points may be visited twice.
  template <typename Visit>
  void each_block(Visit&& visit) const {
    const auto first = static_cast<std::int32_t>(first_);
    if (end_ - first_ < kLanes) {
      const Integers index = ascending_to(first, static_cast<std::int32_t>(end_ - 1U));
      visit(squared(gather(words_, index)), index);
      return;
    }
    Integers index = ascending_from(first);
    std::uint32_t p = first_;
    for (; end_ - p >= kLanes; p += kLanes) {  // bound: points_per_leaf_max
      visit(squared(load<Words>(words_ + p)), index);
      index += static_cast<std::int32_t>(kLanes);
    }
    if (p != end_) {
      visit(squared(load<Words>(words_ + (end_ - kLanes))),
            index - static_cast<std::int32_t>(p + kLanes - end_));
    }
  }

 private:
  // The bits of x and y are converted to float without a shift; the scale contains their power of
  // two. The result is rounded like length_squared(offset()).
  [[nodiscard]] Floats squared(Words words) const {
    const Floats x = (0.25F * scale_) * to_floats(words & 0xFFCU) - local_.x;
    const Floats y = (0.25F / 1024.0F * scale_) * to_floats(words & 0x3FF000U) - local_.y;
    const Floats z = scale_ * to_floats(words >> 22) - local_.z;
    return x * x + y * y + z * z;
  }
  static float coordinate(std::uint32_t site) {
    return static_cast<float>(static_cast<std::int32_t>(site));
  }

  const std::uint32_t* words_;
  std::uint32_t first_;
  std::uint32_t end_;
  float scale_;
  Vec3 local_;
};

/// True if the probe is in the axis-aligned box, of half-width `half`, around a point of the leaf.
inline bool leaf_has_box_around(const BlobView& view, const NearLeaf& leaf, float half) {
  const LeafScan scan(view, leaf);
  for (std::uint32_t p = leaf.first_point; p < leaf.end_point; ++p) {  // bound: points_per_leaf_max
    const Vec3 d = scan.offset(p);
    if (absolute(d.x) <= half && absolute(d.y) <= half && absolute(d.z) <= half) {
      return true;
    }
  }
  return false;
}

}  // namespace tactree::core
