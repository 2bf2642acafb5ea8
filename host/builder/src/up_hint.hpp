#pragma once
// Checks whether a body seems to lie on its side.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Below this ratio of points with material behind them, a body is so open that its flat base may
/// be the only part that was scanned.
inline constexpr double kBodyShare = 0.9;

struct FlatBase {
  UpAxis up = UpAxis::kZ;  ///< the base is at the low end of this axis
  double share = 0.0;      ///< ratio of the points that lie on it
};

/// The flat face on which a body stands: at an end of its box, and several times larger than the
/// flat part at every other end. Returns nullopt for bodies without such a face (a sphere) or with
/// several (a box, a cylinder), and if the face is at a high end, because the body may be upside
/// down or open below. Preconditions: evenly spaced points with outward normals. Cost: 10 ns per
/// point.
[[nodiscard]] std::optional<FlatBase> flat_base(std::span<const Eigen::Vector3d> positions,
                                                std::span<const Eigen::Vector3f> normals,
                                                double spacing);

[[nodiscard]] char letter_of(UpAxis axis);

/// States that a body lies on its side, for a base that is not at the low end of z.
[[nodiscard]] std::string describe_lying(const FlatBase& base);

}  // namespace tactree::builder
