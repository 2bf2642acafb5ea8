#pragma once
// The points and triangles of a mesh file, and their output in the format of wire.hpp.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::builder {

struct ImportedMesh {
  std::vector<Eigen::Vector3d> positions;  ///< in units of the file
  std::vector<Eigen::Vector3f> normals;    ///< empty, or one per position
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double unit_m = 0.0;  ///< metres per unit; 0: unknown
  std::string warning;  ///< one or more sentences; may be empty
};

/// A mesh file is damaged or needs a feature that no reader supports. what() is the cause, which
/// follows "cannot be read: ".
class ImportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The byte of a colour from 0 to 1; values outside, and NaN, become 0 or 255.
[[nodiscard]] inline std::uint8_t colour_byte(double value) {
  return value > 0.0 ? static_cast<std::uint8_t>(std::lround(255.0 * std::min(value, 1.0)))
                     : std::uint8_t{0};
}

/// Returns false if writing fails.
[[nodiscard]] bool write_mesh(const ImportedMesh& mesh, std::FILE* to);

}  // namespace tactree::builder
