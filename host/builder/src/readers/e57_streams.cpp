#include "e57_streams.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "readers.hpp"
#include "scalar.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kSectionHeaderBytes = 32;
constexpr std::uint64_t kPacketHeaderBytes = 6;  // of a data packet, up to the lengths
constexpr char kPointSection = 1;
constexpr char kIndexPacket = 0;
constexpr char kDataPacket = 1;
constexpr char kEmptyPacket = 2;
constexpr std::size_t kPadding = 9;  // 64 bits that begin within a byte take nine bytes
constexpr std::size_t kMaxWaiting = std::size_t{1} << 26;

/// Loads `bits` bits from bit `at` on, the lowest first.
std::uint64_t load_packed(const char* bytes, std::uint64_t at, unsigned bits) {
  const char* first = bytes + at / 8;
  const unsigned shift = at % 8;
  std::uint64_t value = load_bits<std::uint64_t, false>(first) >> shift;
  if (shift != 0) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(first[8])) << (64 - shift);
  }
  return bits == 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

E57Streams::E57Streams(E57Pages& pages, const E57Scan& scan, const std::string& file)
    : pages_(pages), scan_(scan), file_(file), streams_(scan.fields.size()) {
  for (Stream& stream : streams_) stream.bytes.assign(kPadding, '\0');
  read_header();
  check_room();
}

void E57Streams::read_header() {
  const std::uint64_t begin = pages_.to_logical(scan_.offset, "the points of " + scan_.place);
  std::array<char, kSectionHeaderBytes> header{};
  pages_.seek(begin);
  pages_.read(header.data(), header.size());
  const auto length = load_bits<std::uint64_t, false>(header.data() + 8);
  const std::uint64_t first = load_bits<std::uint64_t, false>(header.data() + 16);
  if (header[0] != kPointSection) fail("its points do not begin with the header of a section");
  if (length < kSectionHeaderBytes || length > pages_.size() - begin) {
    fail(fmt::format("its points take {} bytes, only {} are present", length,
                     pages_.size() - begin));
  }
  end_ = begin + length;
  data_ = pages_.to_logical(first, "the points of " + scan_.place);
  if (data_ < begin + kSectionHeaderBytes || data_ > end_) {
    fail("its first packet is outside of the section of its points");
  }
}

void E57Streams::check_room() const {
  std::uint64_t bits_per_point = 0;
  for (const E57Field& field : scan_.fields) {
    if (field.type != E57Field::Type::kText) bits_per_point += field.bits;
  }
  // Points whose fields take no bits are all equal. Their number is limited as if they took one
  // bit.
  const std::uint64_t room = 8 * (end_ - data_) / std::max<std::uint64_t>(bits_per_point, 1);
  if (scan_.count > room) {
    fail(fmt::format("{} points are declared, there is room for {}", scan_.count, room));
  }
}

void E57Streams::read(const std::function<void(const std::vector<double>& values)>& add) {
  std::vector<double> values(scan_.fields.size());
  std::uint64_t left = scan_.count;
  while (left > 0) {
    const std::uint64_t points = std::min(left, complete_points());
    for (std::uint64_t i = 0; i < points; ++i) {
      for (std::size_t k = 0; k < values.size(); ++k) values[k] = next(k);
      add(values);
    }
    discard_read();
    left -= points;
    if (left > 0 && !read_packet()) {
      fail(fmt::format("{} points are declared, only {} are present", scan_.count,
                       scan_.count - left));
    }
  }
}

/// Returns false at the end of the section.
bool E57Streams::read_packet() {
  if (end_ - data_ < 4) return false;
  std::array<char, 4> header{};
  pages_.seek(data_);
  pages_.read(header.data(), header.size());
  const std::uint64_t bytes = load_bits<std::uint16_t, false>(header.data() + 2) + std::uint64_t{1};
  if (bytes < 4 || bytes % 4 != 0 || bytes > end_ - data_) {
    fail(fmt::format("a packet of its points has {} bytes, at most {} are present", bytes,
                     end_ - data_));
  }
  switch (header[0]) {
    case kDataPacket:
      read_data_packet(bytes);
      break;
    case kIndexPacket:
    case kEmptyPacket:
      break;
    default:
      fail(fmt::format("a packet of its points has the unknown type {}",
                       static_cast<unsigned char>(header[0])));
  }
  data_ += bytes;
  return true;
}

void E57Streams::read_data_packet(std::uint64_t bytes) {
  if (bytes < kPacketHeaderBytes) {
    fail(fmt::format("a packet of its points has {} bytes, its header alone {}", bytes,
                     kPacketHeaderBytes));
  }
  pages_.seek(data_);
  packet_.resize(static_cast<std::size_t>(bytes));
  pages_.read(packet_.data(), packet_.size());
  const std::uint64_t lengths_end = kPacketHeaderBytes + 2 * scan_.fields.size();
  const std::uint16_t count = load_bits<std::uint16_t, false>(packet_.data() + 4);
  if (count != scan_.fields.size() || lengths_end > bytes) {
    fail(fmt::format("a packet has {} streams, a point {} fields", count, scan_.fields.size()));
  }
  std::uint64_t at = lengths_end;
  for (std::size_t k = 0; k < scan_.fields.size(); ++k) {
    const std::size_t length =
        load_bits<std::uint16_t, false>(packet_.data() + kPacketHeaderBytes + 2 * k);
    if (length > bytes - at) fail("a stream of its points exceeds its packet");
    if (scan_.fields[k].type != E57Field::Type::kText) {
      std::vector<char>& to = streams_[k].bytes;
      if (to.size() + length > kMaxWaiting) {
        fail(
            fmt::format("the values of \"{}\" are too far from the other values of the same points",
                        scan_.fields[k].name));
      }
      to.insert(to.end() - kPadding, packet_.begin() + static_cast<std::ptrdiff_t>(at),
                packet_.begin() + static_cast<std::ptrdiff_t>(at + length));
    }
    at += length;
  }
}

/// Number of points whose fields have all been read from packets.
std::uint64_t E57Streams::complete_points() const {
  std::uint64_t complete = scan_.count;
  for (std::size_t k = 0; k < streams_.size(); ++k) {
    const E57Field& field = scan_.fields[k];
    if (field.type == E57Field::Type::kText || field.bits == 0) continue;
    const std::uint64_t bits = 8 * (streams_[k].bytes.size() - kPadding) - streams_[k].bit;
    complete = std::min(complete, bits / field.bits);
  }
  return complete;
}

double E57Streams::next(std::size_t index) {
  const E57Field& field = scan_.fields[index];
  Stream& stream = streams_[index];
  const char* at = stream.bytes.data() + stream.bit / 8;
  const std::uint64_t bit = stream.bit;
  stream.bit += field.bits;
  switch (field.type) {
    case E57Field::Type::kSingle:
      return load_scalar<false>(at, ScalarType::kFloat32);
    case E57Field::Type::kDouble:
      return load_scalar<false>(at, ScalarType::kFloat64);
    case E57Field::Type::kInteger: {
      const std::uint64_t packed = load_packed(stream.bytes.data(), bit, field.bits);
      const auto number =
          static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + packed);
      return field.offset + field.scale * static_cast<double>(number);
    }
    case E57Field::Type::kText:
      break;
  }
  stream.bit = 0;
  return 0.0;
}

void E57Streams::discard_read() {
  for (Stream& stream : streams_) {
    const auto whole = static_cast<std::ptrdiff_t>(stream.bit / 8);
    stream.bytes.erase(stream.bytes.begin(), stream.bytes.begin() + whole);
    stream.bit %= 8;
  }
}

void E57Streams::fail(const std::string& cause) const {
  throw ReadError(file_, scan_.place, cause, kCopyAgain);
}

}  // namespace tactree::builder
