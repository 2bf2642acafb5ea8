#pragma once
// Writes small LAS files for tests.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bytes_of.hpp"

namespace tactree::test {

struct LasPoint {
  std::array<std::int32_t, 3> position{};
  std::array<std::uint16_t, 3> colour{};
  bool synthetic = false;
  bool withheld = false;
  std::uint8_t kind = 2;  ///< class
};

struct LasFile {
  int minor = 2;
  int point_format = 0;
  std::vector<LasPoint> points;
  std::array<double, 3> scale = {1, 1, 1};
  std::array<double, 3> offset = {0, 0, 0};
  std::string records;  ///< see las_record()
  std::uint32_t record_count = 0;
  std::size_t extra_bytes = 0;  ///< behind each point
  std::array<double, 6> box{};  ///< largest and smallest x, y, z
  bool text_rules = false;      ///< the coordinate system is that in well-known text
  std::string last_records;     ///< behind the points of version 1.4, see las_extended_record()
  std::uint32_t last_record_count = 0;
};

inline std::string las_record(const std::string& user, std::uint16_t id,
                              const std::string& content) {
  return bytes_of(std::uint16_t{0}) + user + std::string(16 - user.size(), '\0') + bytes_of(id) +
         bytes_of(static_cast<std::uint16_t>(content.size())) + std::string(32, '\0') + content;
}

inline std::string las_extended_record(const std::string& user, std::uint16_t id,
                                       const std::string& content) {
  return bytes_of(std::uint16_t{0}) + user + std::string(16 - user.size(), '\0') + bytes_of(id) +
         bytes_of(std::uint64_t{content.size()}) + std::string(32, '\0') + content;
}

/// Keys of a coordinate system, each with the code of its value.
inline std::string las_geo_keys(const std::vector<std::array<std::uint16_t, 2>>& keys) {
  std::string directory =
      bytes_of(std::array<std::uint16_t, 4>{1, 1, 0, static_cast<std::uint16_t>(keys.size())});
  for (const auto& [key, value] : keys) {
    directory += bytes_of(std::array<std::uint16_t, 4>{key, 0, 1, value});
  }
  return las_record("LASF_Projection", 34735, directory);
}

inline std::string las_point(const LasPoint& point, int format, std::size_t extra_bytes) {
  constexpr std::array<std::size_t, 11> kBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  constexpr std::array<std::size_t, 11> kColour = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const auto kind = static_cast<std::size_t>(format);
  std::string record = bytes_of(point.position);
  record.resize(kBytes[kind] + extra_bytes, '\x55');
  const int flags = format < 6
                        ? (point.synthetic ? 0x20 : 0) | (point.withheld ? 0x80 : 0) | point.kind
                        : (point.synthetic ? 0x01 : 0) | (point.withheld ? 0x04 : 0) | 0xf8;
  record[15] = static_cast<char>(flags);
  if (format >= 6) record[16] = static_cast<char>(point.kind);
  if (kColour[kind] != 0) record.replace(kColour[kind], 6, bytes_of(point.colour));
  return record;
}

inline std::string las_file(const LasFile& file) {
  const std::size_t header_bytes = file.minor < 3 ? 227 : file.minor == 3 ? 235 : 375;
  std::string header = "LASF" + std::string(20, '\0') + '\1' + static_cast<char>(file.minor);
  header.resize(header_bytes, '\0');
  const auto put = [&](std::size_t at, const std::string& bytes) {
    header.replace(at, bytes.size(), bytes);
  };
  const std::string record = las_point({}, file.point_format, file.extra_bytes);
  put(94, bytes_of(static_cast<std::uint16_t>(header_bytes)));
  put(96, bytes_of(static_cast<std::uint32_t>(header_bytes + file.records.size())));
  put(100, bytes_of(file.record_count));
  put(104, std::string(1, static_cast<char>(file.point_format)));
  put(105, bytes_of(static_cast<std::uint16_t>(record.size())));
  // From format 6 on the narrow count is zero.
  if (file.point_format < 6) put(107, bytes_of(static_cast<std::uint32_t>(file.points.size())));
  put(131, bytes_of(file.scale));
  put(155, bytes_of(file.offset));
  put(179, bytes_of(file.box));
  if (file.text_rules) put(6, bytes_of(std::uint16_t{0x10}));
  if (file.minor == 4) put(247, bytes_of(static_cast<std::uint64_t>(file.points.size())));
  std::string bytes = header + file.records;
  for (const LasPoint& point : file.points) {
    bytes += las_point(point, file.point_format, file.extra_bytes);
  }
  if (file.last_record_count > 0) {
    bytes.replace(235, 8, bytes_of(std::uint64_t{bytes.size()}));
    bytes.replace(243, 4, bytes_of(file.last_record_count));
  }
  return bytes + file.last_records;
}

}  // namespace tactree::test
