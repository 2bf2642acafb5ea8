#pragma once
// The XML section of an E57 file: its scans, their offsets and their fields.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tactree::builder {

/// A field of the points. The numbers of each field form a separate stream.
struct E57Field {
  enum class Type : std::uint8_t { kInteger, kSingle, kDouble, kText };

  std::string name;  ///< without the prefix of its namespace
  Type type = Type::kDouble;
  unsigned bits = 64;  ///< of a number in its stream; unused for kText
  // value = offset + scale * (minimum + number in the stream)
  std::int64_t minimum = 0;  ///< minimum, scale and offset: kInteger only
  double scale = 1.0;
  double offset = 0.0;
  double lowest = 0.0;  ///< declared limits of the value; both 0: unknown
  double highest = 0.0;
};

struct E57Scan {
  std::string place;         ///< "scan 2", for messages
  std::uint64_t offset = 0;  ///< physical offset of the section with the points
  std::uint64_t count = 0;   ///< number of points, as declared
  std::vector<E57Field> fields;
  Eigen::Affine3d to_file = Eigen::Affine3d::Identity();  ///< from the frame of the scanner
  bool has_pose = false;                                  ///< to_file is stated
  /// Minimum and maximum values of red, green and blue; both 0: unknown.
  std::array<std::array<double, 2>, 3> colour_limits{};
};

/// Throws ReadError. `file` is the name in messages.
[[nodiscard]] std::vector<E57Scan> parse_e57_index(const std::string& file, std::string xml);

}  // namespace tactree::builder
