#pragma once
// The header of a LAS file, versions 1.0 to 1.4, and the units that its records state.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "input_file.hpp"
#include "las_box.hpp"

namespace tactree::builder {

/// Layout of a point record.
struct LasLayout {
  std::uint16_t least_bytes;
  std::int16_t colour;  ///< offset of red, green and blue, 16 bits each; -1: none
  bool extended;        ///< formats 6 to 10, which have other flags
};

/// Units of length in metres; nullopt: not stated.
struct LasUnits {
  std::optional<double> horizontal;
  std::optional<double> vertical;
  bool degrees = false;        ///< x and y are longitude and latitude
  bool differ = false;         ///< the two forms of the coordinate system state different units
  std::string unknown;         ///< what is stated instead of the unit of x and y
  std::string unknown_height;  ///< what is stated instead of the unit of z
};

/// The records that state the coordinate system.
struct LasProjection {
  std::string keys;         ///< directory of GeoTIFF keys
  std::string numbers;      ///< numbers to which the keys refer
  std::string text;         ///< well-known text
  bool text_rules = false;  ///< by the header, the text is valid and the keys are not
};

struct LasHeader {
  int minor = 0;  ///< version 1.minor
  std::uint8_t point_format = 0;
  LasLayout layout{};
  std::uint16_t record_bytes = 0;
  std::uint64_t first_point = 0;  ///< offset in the file
  std::uint64_t points = 0;       ///< as declared
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  LasBox box;
  LasUnits units;
};

/// Reads the header and the records up to the points, and, by another opening of the file, those
/// behind the points. Throws ReadError.
[[nodiscard]] LasHeader read_las_header(InputFile& file, const std::filesystem::path& path);

[[nodiscard]] LasUnits units_of(const LasProjection& projection);

}  // namespace tactree::builder
