#pragma once
// A scan as read from a file: points or a triangle mesh, in the frame and unit of the file.
// Double precision preserves micrometres in geographic coordinates of 10^6 m.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactree::builder {

/// Position of the scanner for a range of points.
struct ScannerPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< NaN: unknown
  std::size_t first_point = 0;  ///< first point seen from here; the range ends at the next pose
  bool sure = true;  ///< false: may be a default value of the program that wrote the file
};

struct Scan {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;              ///< empty, or one per position (any length)
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< empty, or one per position (R, G, B)
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< empty: a cloud; else a mesh over positions

  std::vector<ScannerPose> poses;  ///< of a cloud, ascending by first point; empty: unknown

  std::optional<double> unit_m;  ///< metres per unit, as stated by the file or its format

  std::string format;  ///< recognised format, e.g. "PLY binary little endian"
  std::map<std::string, std::uint64_t> dropped;  ///< cause -> count, e.g. "non_finite" -> 3
  std::vector<std::string> warnings;             ///< one sentence each, for the user
  std::vector<std::string> notes;                ///< how the file was read, one sentence each

  [[nodiscard]] bool is_mesh() const { return !triangles.empty(); }
};

/// A file was refused. what() is "file: place: cause (hint)".
class ReadError : public std::runtime_error {
 public:
  /// `place` is "line 12", "byte 400", "header" or empty; `remedy` is an action for the user.
  ReadError(const std::string& file, const std::string& place, const std::string& cause,
            const std::string& remedy)
      : std::runtime_error(file + (place.empty() ? "" : ": " + place) + ": " + cause +
                           (remedy.empty() ? "" : " (" + remedy + ")")) {}
};

}  // namespace tactree::builder
