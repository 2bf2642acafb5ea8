#pragma once
// The header of a PCD file (Point Cloud Library).

#include <cstdint>
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
  std::uint64_t offset = 0;  ///< in a point, in bytes
  std::uint64_t column = 0;  ///< in a row of text

  [[nodiscard]] std::uint64_t bytes() const { return count * size_of(type); }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;  ///< as promised
  PcdData data = PcdData::kAscii;
  std::vector<std::string> warnings;

  [[nodiscard]] std::uint64_t point_bytes() const;
  [[nodiscard]] std::uint64_t columns() const;
};

/// Reads up to and with the line "DATA ...". Throws ReadError.
[[nodiscard]] PcdHeader read_pcd_header(InputFile& file);

}  // namespace tactree::builder
