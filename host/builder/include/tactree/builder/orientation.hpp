#pragma once
// Which side of a scanned surface is its outside: the rule to find it, and the result.

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

namespace tactree::builder {

enum class OrientationRule : std::uint8_t {
  kAuto,       ///< viewpoints if there are any, else outward, sheets up
  kOutward,    ///< away from the body; sheets to their convex side
  kViewpoint,  ///< towards the scanner
  kUp,         ///< towards +z of the model
  kGiven,      ///< as in the file, unchecked; where it has none, as kAuto
};

/// The evidence for the side of a piece.
enum class OrientationBasis : std::uint8_t {
  kOutside,    ///< one side can be reached from far away
  kEnclosed,   ///< in a hollow of another piece: by the number of surfaces around it
  kViewpoint,  ///< the scanner saw it
  kGiven,      ///< normals of the file, which nothing contradicts
  kUp,         ///< a sheet, reachable from both sides: turned up
  kConvex,     ///< a sheet: turned to its convex side
};

/// A sentence fragment, "it is reached from one side only".
[[nodiscard]] std::string_view describe(OrientationBasis basis);

/// A connected piece of the surface.
struct OrientedPiece {
  std::uint32_t points = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of its points, m
  OrientationBasis basis = OrientationBasis::kOutside;
  double confidence = 1.0;  ///< 0 to 1: share of its points whose side is sure
};

/// Below this confidence a piece is doubtful.
inline constexpr double kLeastConfidence = 0.91;

struct OrientationReport {
  bool checked = false;                ///< false: the normals were taken from the file
  std::vector<OrientedPiece> pieces;   ///< largest first
  double confidence = 1.0;             ///< mean of the pieces, by points
  std::uint64_t doubtful_points = 0;   ///< of doubtful pieces
  std::uint64_t reversed_normals = 0;  ///< of the file
  std::uint64_t reversed_faces = 0;    ///< of a mesh
  /// Positions of the scanner that the file states and its points confirm; source units and axes.
  std::vector<Eigen::Vector3d> scanners;
};

}  // namespace tactree::builder
