#pragma once
// The header of a LAS file, versions 1.0 to 1.4, and the units that its records state.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "input_file.hpp"

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
  bool degrees = false;  ///< x and y are longitude and latitude
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
  LasUnits units;
};

/// Reads the header and the records up to the points. Throws ReadError.
[[nodiscard]] LasHeader read_las_header(InputFile& file);

/// Adds the units that the keys of a GeoTIFF directory state.
void add_geo_keys(std::string_view directory, LasUnits& units);
/// Adds the units that a coordinate system in well-known text states.
void add_well_known_text(std::string_view text, LasUnits& units);

}  // namespace tactree::builder
