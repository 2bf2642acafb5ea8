#include "las_header.hpp"

#include <fmt/format.h>

#include <array>

#include "readers.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint16_t kLeastHeaderBytes = 227;
constexpr std::uint16_t kLongHeaderBytes = 375;  // of version 1.4, with a 64-bit count
constexpr std::size_t kRecordHeaderBytes = 54;
constexpr const char* kExportLasAgain = "export the scan as LAS 1.0 to 1.4, or as PLY";

constexpr std::array<LasLayout, 11> kLayouts = {{{20, -1, false},
                                                 {28, -1, false},
                                                 {26, 20, false},
                                                 {34, 28, false},
                                                 {57, -1, false},
                                                 {63, 28, false},
                                                 {30, -1, true},
                                                 {36, 30, true},
                                                 {38, 30, true},
                                                 {59, -1, true},
                                                 {67, 30, true}}};

template <typename Unsigned>
Unsigned load(std::string_view bytes, std::size_t at) {
  return load_bits<Unsigned, false>(bytes.data() + at);
}

[[noreturn]] void fail(const InputFile& file, const std::string& cause, const char* remedy) {
  throw ReadError(file.name(), "header", cause, remedy);
}

void set_layout(const InputFile& file, std::uint8_t format, LasHeader& header) {
  header.point_format = format;
  if (header.point_format >= kLayouts.size()) {
    fail(file, fmt::format("point format {} is not known", header.point_format), kExportLasAgain);
  }
  header.layout = kLayouts[header.point_format];
  if (header.record_bytes < header.layout.least_bytes) {
    fail(file,
         fmt::format("records of {} bytes are declared, point format {} takes {}",
                     header.record_bytes, header.point_format, header.layout.least_bytes),
         kCopyAgain);
  }
}

void set_frame(const InputFile& file, std::string_view head, LasHeader& header) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    header.scale[axis] = load_scalar<false>(head.data() + 131 + 8 * k, ScalarType::kFloat64);
    header.offset[axis] = load_scalar<false>(head.data() + 155 + 8 * k, ScalarType::kFloat64);
  }
  if (!header.scale.allFinite() || !header.offset.allFinite() ||
      (header.scale.array() == 0).any()) {
    fail(file, "the scale or the offset of its coordinates is not usable", kCopyAgain);
  }
}

/// The variable length records lie between the header and the points.
void read_records(InputFile& file, std::uint32_t count, LasHeader& header) {
  LasUnits keys;
  LasUnits text;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (file.offset() + kRecordHeaderBytes > header.first_point) break;
    std::string_view record = file.peek(kRecordHeaderBytes);
    const std::size_t bytes = kRecordHeaderBytes + load<std::uint16_t>(record, 20);
    if (file.offset() + bytes > header.first_point) break;
    record = file.peek(bytes);
    if (record.size() < bytes) break;
    const auto id = load<std::uint16_t>(record, 18);
    if (record.substr(2).starts_with("LASF_Projection")) {
      const std::string_view content =
          record.substr(kRecordHeaderBytes, bytes - kRecordHeaderBytes);
      if (id == 34735) add_geo_keys(content, keys);
      if (id == 2112) add_well_known_text(content, text);
    }
    file.consume(bytes);
  }
  header.units.horizontal = keys.horizontal ? keys.horizontal : text.horizontal;
  header.units.vertical = keys.vertical ? keys.vertical : text.vertical;
  header.units.degrees = keys.degrees || text.degrees;
}

}  // namespace

LasHeader read_las_header(InputFile& file) {
  LasHeader header;
  const std::string_view head = file.peek(kLongHeaderBytes);
  if (head.size() < kLeastHeaderBytes) {
    fail(file, fmt::format("the file ends too early, within its header: {} bytes", head.size()),
         kCopyAgain);
  }
  header.minor = static_cast<unsigned char>(head[25]);
  if (head[24] != 1 || header.minor > 4) {
    fail(file,
         fmt::format("version {}.{} is not supported", static_cast<unsigned char>(head[24]),
                     header.minor),
         kExportLasAgain);
  }
  const auto header_bytes = load<std::uint16_t>(head, 94);
  header.first_point = load<std::uint32_t>(head, 96);
  const auto records = load<std::uint32_t>(head, 100);
  header.record_bytes = load<std::uint16_t>(head, 105);
  header.points = load<std::uint32_t>(head, 107);
  if (header.minor == 4 && header_bytes >= kLongHeaderBytes && head.size() >= kLongHeaderBytes) {
    const auto points = load<std::uint64_t>(head, 247);
    if (points != 0) header.points = points;
  }
  if (header_bytes < kLeastHeaderBytes || header.first_point < header_bytes ||
      header.first_point > file.size()) {
    fail(file,
         fmt::format("the header of {} bytes and points from byte {} on do not fit the file of {} "
                     "bytes",
                     header_bytes, header.first_point, file.size()),
         kCopyAgain);
  }
  set_layout(file, load<std::uint8_t>(head, 104), header);
  set_frame(file, head, header);
  file.skip(header_bytes);
  read_records(file, records, header);
  return header;
}

}  // namespace tactree::builder
