#pragma once
// Orientation of a scanned surface: the rule that determines its outside, and the result.

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

namespace tactree::builder {

enum class OrientationRule : std::uint8_t {
  kAuto,       ///< by viewpoints if there are any, else outward; sheets up
  kOutward,    ///< away from the body; sheets towards their convex side
  kViewpoint,  ///< towards the scanner
  kUp,         ///< towards +z of the model
  kGiven,      ///< as in the file, unchecked; where it has no normals, as kAuto
};

/// The evidence for the orientation of a component.
enum class OrientationBasis : std::uint8_t {
  kOutside,    ///< one side can be reached from far away
  kEnclosed,   ///< inside another component: by the number of surfaces around it
  kViewpoint,  ///< the scanner saw this side
  kGiven,      ///< normals of the file, which no evidence contradicts
  kUp,         ///< a sheet, reachable from both sides: oriented up
  kConvex,     ///< a sheet: oriented towards its convex side
};

/// A sentence fragment such as "it is reached from one side only".
[[nodiscard]] std::string_view describe(OrientationBasis basis);

/// A connected component of the surface.
struct OrientedPiece {
  std::uint32_t points = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of its points, m
  OrientationBasis basis = OrientationBasis::kOutside;
  double confidence = 1.0;  ///< ratio of its points with a certain orientation, 0 .. 1
};

/// Below this confidence the orientation of a component is ambiguous. Of the clouds in
/// docs/RESULTS.md, this names each one in which 4 % of the points or more have the wrong side.
inline constexpr double kLeastConfidence = 0.91;

struct OrientationReport {
  bool checked = false;                ///< false: the normals were taken from the file
  std::vector<OrientedPiece> pieces;   ///< largest first
  double confidence = 1.0;             ///< mean over the components, weighted by points
  std::uint64_t doubtful_points = 0;   ///< points of components with an ambiguous orientation
  std::uint64_t reversed_normals = 0;  ///< of the file
  std::uint64_t reversed_faces = 0;    ///< of a mesh
  /// Positions of the scanner that the file states and its points confirm; source units and axes.
  std::vector<Eigen::Vector3d> scanners;
};

}  // namespace tactree::builder
