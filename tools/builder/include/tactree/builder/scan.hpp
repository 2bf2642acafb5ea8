#pragma once
// A scan as read from a file: points or a triangle mesh, in the file's own frame and unit.
// Double precision: geographic coordinates of 10^6 m keep their micrometres until the builder
// moves the origin.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::builder {

struct Scan {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;              ///< empty, or one per position (any length)
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< empty, or one per position (R, G, B)
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< empty: a cloud; else a mesh over positions

  std::string format;  ///< what was recognised, e.g. "PLY binary little endian"
  std::map<std::string, std::uint64_t> dropped;  ///< cause -> count, e.g. "non_finite" -> 3
  std::vector<std::string> warnings;             ///< one sentence each, for the user

  [[nodiscard]] bool is_mesh() const { return !triangles.empty(); }
};

/// Why a file was refused. `what()` is the whole message: file, place, cause and remedy.
class ReadError : public std::runtime_error {
 public:
  /// place: "line 12", "byte 400", "header" or empty; remedy: what the user can do about it.
  ReadError(const std::string& file, const std::string& place, const std::string& cause,
            const std::string& remedy)
      : std::runtime_error(file + (place.empty() ? "" : ": " + place) + ": " + cause +
                           (remedy.empty() ? "" : " (" + remedy + ")")) {}
};

}  // namespace tactree::builder
