#pragma once
// Bodies with sharp edges (grooves, ridges, slots, rooms), sampled like exact meshes.

#include <Eigen/Core>
#include <random>
#include <vector>

#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

/// A profile in the plane y = 0 (x, z), counter-clockwise as seen from -y, extruded along y within
/// +-half_m. The ends are open; a probe must stay 3 mm away from them.
struct Prism {
  std::vector<Eigen::Vector2d> profile;  // m
  double half_m = 0.02;
  /// From the prism's frame to the model's.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  /// Signed distance of a position in the model's frame, m, positive outside; ignores the ends.
  [[nodiscard]] double distance(const Eigen::Vector3d& place) const;
};

/// A block with a groove along y with this opening angle, 20 .. 160 degrees. The bottom of the
/// groove is at the origin, and the free space is above it.
[[nodiscard]] Prism groove(double angle_deg);
/// A ridge along y with its top at the origin and this angle between its sides.
[[nodiscard]] Prism ridge(double angle_deg);
/// A slot of this width, 10 mm deep, with its floor at z = 0.
[[nodiscard]] Prism slot(double width_m);

/// Points on the faces, half a spacing from the edges. Each is displaced along its face by up to
/// `shift` spacings at random, and normal to it by a Gaussian error with a standard deviation of
/// `noise` spacings.
[[nodiscard]] Shape sampled(const Prism& prism, double spacing_m, double shift, double noise,
                            unsigned seed);

/// The inside of a cube of this half width, centred at the origin: its walls face the centre.
[[nodiscard]] Shape room(double half_m, double spacing_m, double shift, unsigned seed,
                         const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

/// A random rotation, uniformly distributed.
[[nodiscard]] Eigen::Matrix3d any_turn(std::mt19937_64& random);

}  // namespace tactree::evaluation
