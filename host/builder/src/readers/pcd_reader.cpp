#include <fmt/format.h>
#include <lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "number.hpp"
#include "pcd_header.hpp"
#include "range_image.hpp"
#include "readers.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

/// Maximum compression ratio: LZF encodes at most 264 bytes in 3.
constexpr std::uint64_t kMaxLzfRatio = 88;

/// A field of a point that is in use.
struct UsedField {
  PcdField field;
  Slot slot = kNoSlot;
  bool packed_colour = false;
};

/// Refuses names of which it is not known which one is meant.
void check_names(const InputFile& file, const std::vector<UsedField>& used, const PcdField& field) {
  for (const UsedField& earlier : used) {
    if (!equal_ignoring_case(earlier.field.name, field.name)) continue;
    throw ReadError(
        file.name(), "header",
        fmt::format("FIELDS names both \"{}\" and \"{}\"", earlier.field.name, field.name),
        "export the scan again, with one field of each name");
  }
}

std::vector<UsedField> used_fields(const InputFile& file, const PcdHeader& header) {
  std::vector<UsedField> used;
  std::array<bool, kSlots> filled{};
  bool packed = false;
  for (const PcdField& field : header.fields) {
    if (field.count != 1) continue;
    const bool colour = field.name == "rgb" || field.name == "rgba";
    if (colour && size_of(field.type) == 4 && !packed) {
      packed = true;
      used.push_back({field, kRed, true});
      continue;
    }
    const Slot slot = slot_of_name(field.name);
    if (slot == kNoSlot) continue;
    check_names(file, used, field);
    if (filled[slot]) continue;
    filled[slot] = true;
    used.push_back({field, slot, false});
  }
  if (!filled[kX] || !filled[kY] || !filled[kZ]) {
    throw ReadError(file.name(), "header", "FIELDS does not name x, y and z",
                    "export the scan again with its coordinates");
  }
  const bool normals = filled[kNx] && filled[kNy] && filled[kNz];
  const bool colours = !packed && filled[kRed] && filled[kGreen] && filled[kBlue];
  std::erase_if(used, [&](const UsedField& field) {
    if (field.slot >= kRed) return !colours && !field.packed_colour;
    return field.slot >= kNx && !normals;
  });
  return used;
}

void unpack_colour(std::uint32_t packed, PointRow& row) {
  row[kRed] = (packed >> 16) & 0xff;
  row[kGreen] = (packed >> 8) & 0xff;
  row[kBlue] = packed & 0xff;
}

/// In text, a packed colour is the integer itself or the float with the same bits.
std::uint32_t packed_from_number(double value, ScalarType type) {
  const bool whole = std::abs(value) >= 1.0 && value == std::floor(value);
  if (!is_float(type) || whole) {
    const double bits = std::clamp(value, -2147483648.0, 4294967295.0);
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(bits));
  }
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

class PcdReader {
 public:
  PcdReader(InputFile& file, const ReadOptions& options)
      : file_(file),
        header_(read_pcd_header(file)),
        used_(used_fields(file, header_)),
        builder_(file.name(), options, "byte"),
        image_(header_.width, header_.viewpoint) {}

  Scan read() {
    if (header_.points == 0) {
      throw ReadError(file_.name(), "header",
                      "the file contains no points: its header declares 0 points",
                      "check the export, and export it again");
    }
    for (const std::string& warning : header_.warnings) builder_.warn(warning);
    for (const UsedField& used : used_) {
      if (used.slot == kNx) builder_.use_normals();
      if (used.slot == kRed) builder_.use_colours(range_of(used));
    }
    builder_.thin_large_cloud();
    builder_.begin_pose();
    switch (header_.data) {
      case PcdData::kAscii:
        read_ascii();
        return finish("PCD ascii");
      case PcdData::kBinary:
        read_binary();
        return finish("PCD binary");
      case PcdData::kBinaryCompressed:
        break;
    }
    read_compressed();
    return finish("PCD binary compressed");
  }

 private:
  void add_point(const PointRow& row) {
    image_.add({row[kX], row[kY], row[kZ]});
    builder_.add_point(row);
  }

  Scan finish(const char* format) {
    if (const std::optional<ScannerPose> pose = image_.pose()) {
      builder_.set_pose(pose->position, pose->sure);
    } else if (header_.width != 0) {
      builder_.warn(
          "The rows of the image do not fit the VIEWPOINT of the file, nor the origin; it was "
          "ignored (give --viewpoint X,Y,Z of the scanner).");
    }
    return builder_.finish(format);
  }

  static ColourRange range_of(const UsedField& used) {
    return used.packed_colour ? ColourRange::kByte : colour_range(used.field.type);
  }

  [[noreturn]] void throw_truncated(std::uint64_t points_there) const {
    throw ReadError(
        file_.name(), fmt::format("byte {}", file_.size()),
        fmt::format("the file ends too early: its header declares {} points, only {} are present",
                    header_.points, points_there),
        kCopyAgain);
  }

  void load(const UsedField& used, const char* at, PointRow& row) const {
    if (used.packed_colour) {
      unpack_colour(load_bits<std::uint32_t, false>(at), row);
    } else {
      row[used.slot] = load_scalar<false>(at, used.field.type);
    }
  }

  void read_binary() {
    const std::uint64_t point_bytes = header_.point_bytes();
    const std::uint64_t there = file_.remaining() / point_bytes;
    if (there < header_.points) throw_truncated(there);
    builder_.reserve_points(header_.points);
    PointRow row{};
    for (std::uint64_t left = header_.points; left > 0;) {
      const std::string_view block =
          file_.peek(std::max(static_cast<std::size_t>(point_bytes), kBlockBytes));
      const std::uint64_t points = std::min<std::uint64_t>(left, block.size() / point_bytes);
      if (points == 0) throw_truncated(header_.points - left);
      const char* at = block.data();
      for (std::uint64_t i = 0; i < points; ++i, at += point_bytes) {
        for (const UsedField& used : used_) load(used, at + used.field.offset, row);
        add_point(row);
      }
      file_.consume(static_cast<std::size_t>(points * point_bytes));
      left -= points;
    }
    const std::uint64_t more = file_.remaining() / point_bytes;
    if (more > 0 && !file_.only_zeros_left()) {
      builder_.warn_of_more("points", header_.points, header_.points + more);
    }
  }

  /// Two sizes, then the LZF stream of all first fields, all second fields, and so on.
  void read_compressed() {
    const std::vector<char> data = decompress();
    std::vector<const char*> columns;
    for (const UsedField& used : used_) {
      columns.push_back(data.data() + header_.points * used.field.offset);
    }
    PointRow row{};
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      for (std::size_t k = 0; k < used_.size(); ++k) {
        load(used_[k], columns[k] + i * size_of(used_[k].field.type), row);
      }
      add_point(row);
    }
    const std::uint64_t more = file_.remaining();
    if (more > 0 && !file_.only_zeros_left()) {
      builder_.warn(fmt::format(
          "{} bytes after the {} points that the file declares were left out (the header is "
          "damaged, or two files were joined; export the scan again).",
          more, header_.points));
    }
  }

  std::vector<char> decompress() {
    const std::uint64_t place = file_.offset();
    const std::string_view sizes = file_.peek(8);
    if (sizes.size() < 8) throw_truncated(0);
    const std::uint32_t packed_size = load_bits<std::uint32_t, false>(sizes.data());
    const std::uint32_t full_size = load_bits<std::uint32_t, false>(sizes.data() + 4);
    file_.consume(8);
    check_compressed_sizes(place, packed_size, full_size);
    builder_.charge(std::uint64_t{packed_size} + full_size);
    builder_.reserve_points(header_.points);
    std::vector<char> packed;
    packed.reserve(packed_size);
    while (packed.size() < packed_size) {
      const std::string_view block = file_.peek(1);
      if (block.empty()) throw_truncated(0);
      const std::size_t take = std::min(block.size(), packed_size - packed.size());
      packed.insert(packed.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(take));
      file_.consume(take);
    }
    std::vector<char> full(full_size);
    if (::lzf_decompress(packed.data(), packed_size, full.data(), full_size) != full_size) {
      fail(place, "the compressed data is damaged");
    }
    return full;
  }

  void check_compressed_sizes(std::uint64_t place, std::uint64_t packed, std::uint64_t full) const {
    std::uint64_t expected = 0;
    const bool overflow = __builtin_mul_overflow(header_.points, header_.point_bytes(), &expected);
    if (overflow || full != expected) {
      fail(place, fmt::format("the data is {} bytes when unpacked, but the {} points of the header "
                              "take {} bytes each",
                              full, header_.points, header_.point_bytes()));
    }
    if (packed > file_.remaining()) {
      throw ReadError(file_.name(), fmt::format("byte {}", file_.size()),
                      fmt::format("the file ends too early: {} bytes of compressed data for {} "
                                  "points are declared, only {} are present",
                                  packed, header_.points, file_.remaining()),
                      kCopyAgain);
    }
    if (packed == 0 || full / kMaxLzfRatio > packed) {
      fail(place, fmt::format("{} bytes cannot be the compressed form of {} bytes", packed, full));
    }
  }

  void read_ascii() {
    const std::uint64_t columns = header_.columns();
    const std::uint64_t room = (file_.remaining() + 1) / (2 * columns);
    builder_.expect_points(std::min(header_.points, room));
    std::vector<const UsedField*> of_column(static_cast<std::size_t>(columns), nullptr);
    for (const UsedField& used : used_) {
      of_column[static_cast<std::size_t>(used.field.column)] = &used;
    }
    std::string_view line;
    for (std::uint64_t i = 0; i < header_.points;) {
      if (!file_.next_line(line)) throw_truncated(i);
      if (trim(line).empty()) continue;
      read_row(line, of_column);
      ++i;
    }
    warn_of_more_rows();
  }

  void read_row(std::string_view rest, const std::vector<const UsedField*>& of_column) {
    PointRow row{};
    for (const UsedField* used : of_column) {
      const std::string_view word = take_word(rest);
      if (word.empty()) {
        fail_line(fmt::format("the row has fewer than {} values", of_column.size()));
      }
      double value = 0;
      if (used == nullptr) continue;
      if (!parse_number(word, value)) {
        fail_line(fmt::format("\"{}\" is not a number", printable(word)));
      }
      if (used->packed_colour && std::isnan(value)) {
        row[kRed] = row[kGreen] = row[kBlue] = value;  // bits with an alpha of 255, lost in text
      } else if (used->packed_colour) {
        unpack_colour(packed_from_number(value, used->field.type), row);
      } else {
        row[used->slot] = value;
      }
    }
    if (!trim(rest).empty()) {
      fail_line(fmt::format("the row has more than {} values", of_column.size()));
    }
    add_point(row);
  }

  void warn_of_more_rows() {
    std::uint64_t more = 0;
    std::string_view line;
    while (file_.next_line(line)) more += trim(line).empty() ? 0U : 1U;
    if (more > 0) builder_.warn_of_more("points", header_.points, header_.points + more);
  }

  [[noreturn]] void fail(std::uint64_t place, const std::string& cause) const {
    throw ReadError(file_.name(), fmt::format("byte {}", place), cause, kCopyAgain);
  }
  [[noreturn]] void fail_line(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyAgain);
  }

  InputFile& file_;
  PcdHeader header_;
  std::vector<UsedField> used_;
  ScanBuilder builder_;
  RangeImage image_;
};

}  // namespace

Scan read_pcd(InputFile& file, const ReadOptions& options) {
  return PcdReader(file, options).read();
}

}  // namespace tactree::builder
