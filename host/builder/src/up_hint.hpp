#pragma once
// Checks whether a body seems to lie on its side.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Below this ratio of points with material behind them, a body is an open shell: its flat base may
/// be the only part that was scanned.
inline constexpr double kBodyShare = 0.9;

/// The evidence for an axis that is up.
enum class UpEvidence : std::uint8_t {
  kFlat,    ///< the body has a flat base at an end of the axis
  kOpen,    ///< it is open there
  kLongest  ///< it is longest along the axis: a possibility only
};

struct Posture {
  UpAxis up = UpAxis::kZ;
  UpEvidence evidence = UpEvidence::kFlat;
  bool is_high = false;  ///< the base is at the high end of the axis
  double share = 0.0;    ///< ratio of the surface, with its openings, that is the base
};

/// How a body lies that does not stand on its lowest z. Its base is at an end of its box, flat or
/// open, and several times larger than that at every other end. A body without such an end may be
/// clearly longest along x or y. Returns nullopt for upright bodies, for those that stand on flat
/// parts all over their lowest z, and for others without evidence (a sphere, a cube). Of an open
/// shell only an opening tells, and only if the shell is about as deep as wide: that of a relief
/// tells where it faces.
/// Preconditions: evenly spaced points with outward normals. Cost: 10 ns per point.
[[nodiscard]] std::optional<Posture> lying_posture(std::span<const Eigen::Vector3d> positions,
                                                   std::span<const Eigen::Vector3f> normals,
                                                   std::span<const Opening> openings,
                                                   double spacing, bool is_shell = false);

[[nodiscard]] char letter_of(UpAxis axis);

/// States how a body lies.
[[nodiscard]] std::string describe_lying(const Posture& posture);

/// States what --axis does to it.
[[nodiscard]] std::string describe_turn(const Posture& posture);

}  // namespace tactree::builder
