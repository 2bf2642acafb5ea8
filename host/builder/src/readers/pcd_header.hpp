#pragma once
// The header of a PCD file (Point Cloud Library).

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "input_file.hpp"
#include "scalar.hpp"

namespace tactree::builder {

enum class PcdData : std::uint8_t { kAscii, kBinary, kBinaryCompressed };

struct PcdField {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::uint64_t count = 1;   ///< values per point
  std::uint64_t offset = 0;  ///< offset in a point, bytes
  std::uint64_t column = 0;  ///< column in a row of text

  [[nodiscard]] std::uint64_t bytes() const { return count * size_of(type); }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;                  ///< as declared
  std::uint64_t width = 0;                   ///< points per row of the image; 0: no image
  std::optional<Eigen::Vector3d> viewpoint;  ///< position of the scanner
  PcdData data = PcdData::kAscii;
  std::vector<std::string> warnings;

  [[nodiscard]] std::uint64_t point_bytes() const;
  [[nodiscard]] std::uint64_t columns() const;
};

/// Reads the header including the line "DATA ...". Throws ReadError.
[[nodiscard]] PcdHeader read_pcd_header(InputFile& file);

}  // namespace tactree::builder
