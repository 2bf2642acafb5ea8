#pragma once
// Bodies with sharp edges, sampled as exact meshes are: grooves, ridges, gaps, corners.

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

/// A profile in the plane y = 0 (x, z), counter-clockwise as seen from -y, extruded along y within
/// +-half_m. The ends are open: stay 3 mm away from them.
struct Prism {
  std::vector<Eigen::Vector2d> profile;  // m
  double half_m = 0.02;
  /// From the prism's frame to the model's.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  /// Signed distance of a place in the model's frame, m, positive outside; the ends are ignored.
  [[nodiscard]] double distance(const Eigen::Vector3d& place) const;
};

/// A block with a groove of this opening angle along y: its bottom is at the origin, the free space
/// above. 20 .. 160 degrees.
[[nodiscard]] Prism groove(double angle_deg);
/// A ridge along y with its top at the origin and this angle between its sides.
[[nodiscard]] Prism ridge(double angle_deg);
/// A slot of this width, 10 mm deep, with its floor at z = 0.
[[nodiscard]] Prism slot(double width_m);

/// Points on the faces, half a spacing from the edges, each moved along its face by up to `shift`
/// spacings, and off it by a normal error of `noise` spacings.
[[nodiscard]] Shape sampled(const Prism& prism, double spacing_m, double shift, double noise,
                            unsigned seed);

/// A cube from inside, of this half width: the walls face its middle, which is the origin.
[[nodiscard]] Shape room(double half_m, double spacing_m, double shift, unsigned seed,
                         const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

/// A rotation of any direction and angle.
[[nodiscard]] Eigen::Matrix3d any_turn(std::mt19937_64& random);

}  // namespace tactree::evaluation
