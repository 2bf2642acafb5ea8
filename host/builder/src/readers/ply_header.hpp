#pragma once
// The header of a PLY file.

#include <cstdint>
#include <string>
#include <vector>

#include "input_file.hpp"
#include "scalar.hpp"

namespace tactree::builder {

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  bool is_list = false;
  ScalarType count_type = ScalarType::kUint8;  // type of the length of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< as declared
  std::vector<PlyProperty> properties;

  /// Minimum size of a row in a binary file, with all lists empty.
  [[nodiscard]] std::uint64_t min_row_bytes() const;
  [[nodiscard]] bool has_list() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::uint64_t unknown_lines = 0;  ///< ignored lines, such as notes of a scanner
  std::string unknown_line;         ///< position and first word of the first one
};

/// Reads the header including the line "end_header". Throws ReadError.
[[nodiscard]] PlyHeader read_ply_header(InputFile& file);

}  // namespace tactree::builder
