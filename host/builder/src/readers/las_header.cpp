#include "las_header.hpp"

#include <fmt/format.h>

#include <array>

#include "readers.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint16_t kLeastHeaderBytes = 227;
constexpr std::uint16_t kLongHeaderBytes = 375;  // of version 1.4, with a 64-bit count
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

/// The lengths are 16 bits wide, and 64 bits in the records behind the points.
struct RecordForm {
  std::size_t header_bytes;
  bool extended;
};
constexpr RecordForm kRecord = {54, false};
constexpr RecordForm kExtendedRecord = {60, true};
constexpr std::uint64_t kMaxProjectionBytes = std::uint64_t{1} << 20;

void keep_projection(std::uint16_t id, std::string_view content, LasProjection& projection) {
  if (id == 34735) projection.keys = content;
  if (id == 34736) projection.numbers = content;
  if (id == 2112) projection.text = content;
}

/// Returns false if the records go beyond `end`.
bool read_records(InputFile& file, const RecordForm& form, std::uint32_t count, std::uint64_t end,
                  LasProjection& projection) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (file.offset() + form.header_bytes > end) return false;
    const std::string_view record = file.peek(form.header_bytes);
    if (record.size() < form.header_bytes) return false;
    const auto id = load<std::uint16_t>(record, 18);
    const bool projects = record.substr(2).starts_with("LASF_Projection");
    const std::uint64_t bytes =
        form.extended ? load<std::uint64_t>(record, 20) : load<std::uint16_t>(record, 20);
    file.consume(form.header_bytes);
    if (bytes > end - file.offset()) return false;
    if (projects && bytes <= kMaxProjectionBytes) {
      const std::string_view content = file.peek(static_cast<std::size_t>(bytes));
      keep_projection(id, content.substr(0, static_cast<std::size_t>(bytes)), projection);
    }
    file.skip(bytes);
  }
  return true;
}

/// From version 1.4 on, records may follow the points. Returns false if they are not in the file.
bool read_extended_records(const InputFile& opened, const std::filesystem::path& path,
                           std::uint64_t begin, std::uint32_t count, LasProjection& projection) {
  if (count == 0) return true;
  if (begin >= opened.size()) return false;
  InputFile file(path, nullptr, opened.name());  // its progress is not that of the points
  file.skip(begin);
  return read_records(file, kExtendedRecord, count, file.size(), projection);
}

void set_box(std::string_view head, LasBox& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    box.most[axis] = load_scalar<false>(head.data() + 179 + 16 * k, ScalarType::kFloat64);
    box.least[axis] = load_scalar<false>(head.data() + 187 + 16 * k, ScalarType::kFloat64);
  }
}

}  // namespace

LasHeader read_las_header(InputFile& file, const std::filesystem::path& path) {
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
  std::uint64_t extended_begin = 0;
  std::uint32_t extended = 0;
  LasProjection projection;
  constexpr std::uint16_t kTextRules = 0x10;
  projection.text_rules = (load<std::uint16_t>(head, 6) & kTextRules) != 0;
  if (header.minor == 4 && header_bytes >= kLongHeaderBytes && head.size() >= kLongHeaderBytes) {
    const auto points = load<std::uint64_t>(head, 247);
    if (points != 0) header.points = points;
    extended_begin = load<std::uint64_t>(head, 235);
    extended = load<std::uint32_t>(head, 243);
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
  set_box(head, header.box);
  file.skip(header_bytes);
  (void)read_records(file, kRecord, records, header.first_point, projection);
  const bool complete = read_extended_records(file, path, extended_begin, extended, projection);
  header.units = units_of(projection);
  if (!complete && !header.units.horizontal && header.units.unknown.empty()) {
    header.units.unknown = "records behind its points that are not in the file";
  }
  return header;
}

}  // namespace tactree::builder
