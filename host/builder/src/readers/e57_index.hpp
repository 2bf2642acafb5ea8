#pragma once
// The XML section of an E57 file: which scans it holds, where, and in which form.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::builder {

/// One number of each point. The numbers of all points are a stream of their own.
struct E57Field {
  enum class Type : std::uint8_t { kInteger, kSingle, kDouble, kText };

  std::string name;  ///< without the prefix of its namespace
  Type type = Type::kDouble;
  unsigned bits = 64;  ///< of a number in its stream; of kText unused
  // value = offset + scale * (minimum + number in the stream)
  std::int64_t minimum = 0;  ///< the rest: kInteger only
  double scale = 1.0;
  double offset = 0.0;
  double lowest = 0.0;  ///< declared limits of the value, both 0: unknown
  double highest = 0.0;
};

struct E57Scan {
  std::string place;         ///< "scan 2", for messages
  std::uint64_t offset = 0;  ///< physical, of the section with the points
  std::uint64_t count = 0;   ///< of the points, as declared
  std::vector<E57Field> fields;
  Eigen::Affine3d to_file = Eigen::Affine3d::Identity();  ///< from the scanner's frame
  bool has_pose = false;                                  ///< to_file is stated
  /// Red, green, blue: the values of no light and of most, both 0: unknown.
  std::array<std::array<double, 2>, 3> colour_limits{};
};

/// Throws ReadError. file: for messages.
[[nodiscard]] std::vector<E57Scan> parse_e57_index(const std::string& file, std::string xml);

}  // namespace tactree::builder
