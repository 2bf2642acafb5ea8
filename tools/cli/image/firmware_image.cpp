#include "image/firmware_image.hpp"

#include <elf.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <span>
#include <utility>

#include "tactree/core/math/crc32.hpp"
#include "tactree/runtime/image_record.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

// Layout of firmware/runtime/identity.hpp on a 32-bit processor.
struct Identity {
  char mark[8];
  char board[24];
  std::uint32_t code_begin;
  std::uint32_t code_end;
  std::uint32_t blob_begin;
  std::uint32_t blob_end;
  std::uint32_t uf2_family;
  std::uint32_t checksum;
};
static_assert(sizeof(Identity) == 56);
constexpr char kMark[8] = "TACTIMG";

constexpr std::uintmax_t kMaxImageBytes = 256U << 20;

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : name_(file.string()) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    std::ifstream in(file, std::ios::binary);
    if (error || !in) {
      fail(fmt::format("cannot be read: {}", error ? error.message() : std::strerror(errno)), "");
    }
    if (size > kMaxImageBytes) {
      fail(fmt::format("too large for an image: {} bytes", size), kRemedy);
    }
    bytes_.resize(static_cast<std::size_t>(size));
    if (!in.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(size))) {
      fail("truncated while it was being read", "");
    }
  }

  [[noreturn]] void fail(const std::string& cause, const char* remedy) const {
    const std::string hint = *remedy == '\0' ? "" : fmt::format(" ({})", remedy);
    throw support::UserError(fmt::format("{}: {}{}", name_, cause, hint));
  }

  /// A struct of the file; refuses a truncated file.
  template <class T>
  T at(std::uint32_t offset, const char* what) const {
    T value;
    std::memcpy(&value, part(offset, sizeof value, what).data(), sizeof value);
    return value;
  }

  std::span<const std::byte> part(std::uint32_t offset, std::uint32_t size,
                                  const char* what) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset) {
      fail(fmt::format("truncated: its {} ends at byte {}, the file has {} bytes", what,
                       std::uint64_t{offset} + size, bytes_.size()),
           kRemedy);
    }
    return std::span(bytes_).subspan(offset, size);
  }

  std::vector<std::byte> take() { return std::move(bytes_); }

  static constexpr const char* kRemedy =
      "give the image that `cmake --build --preset <core>` made: "
      "build/<core>/firmware/<board>.elf";

 private:
  std::string name_;
  std::vector<std::byte> bytes_;
};

Elf32_Ehdr read_header(const Reader& reader) {
  const auto header = reader.at<Elf32_Ehdr>(0, "ELF header");
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) {
    reader.fail("not an ELF file", Reader::kRemedy);
  }
  const bool known = header.e_ident[EI_CLASS] == ELFCLASS32 &&
                     header.e_ident[EI_DATA] == ELFDATA2LSB &&
                     (header.e_machine == EM_ARM || header.e_machine == EM_RISCV);
  if (!known || header.e_type != ET_EXEC || header.e_phentsize != sizeof(Elf32_Phdr)) {
    reader.fail("not a program for a 32-bit Arm or RISC-V controller", Reader::kRemedy);
  }
  return header;
}

std::vector<Segment> read_segments(const Reader& reader, const Elf32_Ehdr& header) {
  std::vector<Segment> segments;
  const auto table = reader.part(header.e_phoff, header.e_phnum * std::uint32_t{sizeof(Elf32_Phdr)},
                                 "program header table");
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    Elf32_Phdr entry;
    std::memcpy(&entry, table.data() + i * sizeof entry, sizeof entry);
    if (entry.p_type != PT_LOAD || entry.p_filesz == 0) {
      continue;
    }
    const auto bytes = reader.part(entry.p_offset, entry.p_filesz, "program segment");
    segments.push_back({entry.p_paddr, {bytes.begin(), bytes.end()}});
  }
  std::sort(segments.begin(), segments.end(),
            [](const Segment& a, const Segment& b) { return a.address < b.address; });
  return segments;
}

/// Copies the structures that begin with the mark.
template <class T>
std::vector<std::pair<T, std::uint32_t>> find_marked(const std::vector<Segment>& segments,
                                                     const char (&mark)[8]) {
  std::vector<std::pair<T, std::uint32_t>> found;
  for (const Segment& segment : segments) {
    for (std::size_t i = 0; i + sizeof(T) <= segment.bytes.size(); i += 4) {
      if (std::memcmp(segment.bytes.data() + i, mark, sizeof mark) == 0) {
        T& value = found.emplace_back(T{}, segment.address + static_cast<std::uint32_t>(i)).first;
        std::memcpy(&value, segment.bytes.data() + i, sizeof(T));
      }
    }
  }
  return found;
}

template <std::size_t N>
void require_name(const Reader& reader, const char (&board)[N], std::size_t found) {
  if (found > 1 || board[0] == '\0' || board[N - 1] != '\0') {
    reader.fail("it has several identification records, or one with a malformed board name",
                Reader::kRemedy);
  }
}

// The identity is at the end of the code and is followed by the initial values of variables.
void check_checksum(const Reader& reader, const Identity& identity,
                    const std::vector<Segment>& segments) {
  core::Crc32 checksum;
  for (const Segment& segment : segments) {
    const std::span<const std::byte> bytes(segment.bytes);
    const bool last_of_code =
        bytes.size() >= sizeof identity &&
        std::memcmp(bytes.last(sizeof identity).data(), &identity, sizeof identity) == 0;
    checksum.update(last_of_code ? bytes.first(bytes.size() - sizeof identity.checksum) : bytes);
  }
  if (checksum.value() != identity.checksum) {
    reader.fail("damaged: its checksum does not match", Reader::kRemedy);
  }
}

void check_ranges(const Reader& reader, const FirmwareImage& image) {
  if (image.code_begin >= image.code_end || image.blob_begin >= image.blob_end ||
      image.blob_begin % 4U != 0U) {
    reader.fail("damaged: its address ranges of code and blob are invalid", Reader::kRemedy);
  }
  for (const Segment& segment : image.segments) {
    const std::uint64_t end = std::uint64_t{segment.address} + segment.bytes.size();
    if (segment.address < image.code_begin || end > image.code_end) {
      reader.fail(fmt::format("its bytes {:#010x} .. {:#010x} lie outside the board's code, "
                              "{:#010x} .. {:#010x}",
                              segment.address, end, image.code_begin, image.code_end),
                  Reader::kRemedy);
    }
  }
}

// ---- a firmware outside this tree

constexpr const char* kSealIt = "run seal-image on it, after every change of the file";

/// The segments as ranges, adjacent ones as one.
std::vector<runtime::ByteRange> ranges_of(const std::vector<Segment>& segments) {
  std::vector<runtime::ByteRange> ranges;
  for (const Segment& segment : segments) {
    const auto bytes = static_cast<std::uint32_t>(segment.bytes.size());
    if (!ranges.empty() && ranges.back().address + ranges.back().bytes == segment.address) {
      ranges.back().bytes += bytes;
    } else {
      ranges.push_back({segment.address, bytes});
    }
  }
  return ranges;
}

void check_seal(const Reader& reader, const runtime::ImageRecord& record, std::uint32_t at,
                const std::vector<Segment>& segments) {
  if (record.count == 0U) {
    reader.fail("is not sealed", kSealIt);
  }
  const std::uint32_t checksum_at = at + offsetof(runtime::ImageRecord, checksum);
  const std::vector<runtime::ByteRange> ranges = ranges_of(segments);
  const bool same = record.checksum_at == checksum_at && record.count == ranges.size() &&
                    std::equal(ranges.begin(), ranges.end(), record.ranges);
  core::Crc32 checksum;
  for (const Segment& segment : segments) {
    const std::span<const std::byte> bytes(segment.bytes);
    if (checksum_at < segment.address || checksum_at - segment.address >= bytes.size()) {
      checksum.update(bytes);
      continue;
    }
    const std::size_t before = checksum_at - segment.address;
    checksum.update(bytes.first(before));
    checksum.update(bytes.subspan(before + sizeof record.checksum));
  }
  if (!same || checksum.value() != record.checksum) {
    reader.fail("damaged: its checksum does not match", kSealIt);
  }
}

void require_place(const Reader& reader, bool has_record, const Unstated& unstated) {
  if (!unstated.place) {
    reader.fail(
        has_record ? "its record states no room for a blob"
                   : "not an image of Tactree: it does not name its board",
        "for a firmware of your own state it in the file of the board, --board FILE.json, or "
        "to `tactree image` by --blob-at ADDRESS --room BYTES; or give the image that "
        "`cmake --build --preset <core>` made: build/<core>/firmware/<board>.elf");
  }
}

void set_place(const Reader& reader, const BlobPlace& place, FirmwareImage& image) {
  const std::uint64_t end = std::uint64_t{place.address} + place.room;
  if (place.room == 0U || place.address % 4U != 0U || end > UINT32_MAX) {
    reader.fail(
        fmt::format("{} bytes from {:#010x} are no room for a blob", place.room, place.address),
        "give an address that is a multiple of 4, of memory that the blob has to itself");
  }
  std::uint64_t behind = 0;
  for (const Segment& segment : image.segments) {
    const std::uint64_t segment_end = std::uint64_t{segment.address} + segment.bytes.size();
    if (segment.address < behind || segment_end > UINT32_MAX) {
      reader.fail("damaged: its segments overlap", "link it again");
    }
    behind = segment_end;
    if (segment.address < end && segment_end > place.address) {
      reader.fail(fmt::format("its bytes {:#010x} .. {:#010x} lie in the room of the blob, "
                              "{:#010x} .. {:#010x}",
                              segment.address, segment_end, place.address, end),
                  "keep that memory free in the linker script, or give the blob another place");
    }
  }
  image.code_begin = image.segments.front().address;
  image.code_end = static_cast<std::uint32_t>(behind);
  image.blob_begin = place.address;
  image.blob_end = static_cast<std::uint32_t>(end);
}

void read_own(const Reader& reader, const std::string& name, const Unstated& unstated,
              FirmwareImage& image) {
  const auto records = find_marked<runtime::ImageRecord>(image.segments, runtime::kImageMark);
  if (records.empty()) {
    require_place(reader, false, unstated);
    image.board = unstated.board.empty() ? name : unstated.board;
    set_place(reader, *unstated.place, image);
    return;
  }
  const auto& [record, at] = records.front();
  require_name(reader, record.board, records.size());
  check_seal(reader, record, at, image.segments);
  image.states_room = record.blob_room != 0U;
  if (!image.states_room) {
    require_place(reader, true, unstated);
  }
  image.board = record.board;
  image.clock_hz = record.clock_hz;
  image.uf2_family = record.uf2_family;
  set_place(reader,
            image.states_room ? BlobPlace{record.blob_at, record.blob_room} : *unstated.place,
            image);
}

void read_ours(const Reader& reader, const Identity& identity, FirmwareImage& image) {
  image.board = identity.board;
  image.states_room = true;
  image.code_begin = identity.code_begin;
  image.code_end = identity.code_end;
  image.blob_begin = identity.blob_begin;
  image.blob_end = identity.blob_end;
  image.uf2_family = identity.uf2_family;
  check_ranges(reader, image);
  check_checksum(reader, identity, image.segments);
}

}  // namespace

FirmwareImage read_firmware(const std::filesystem::path& file, const Unstated& unstated) {
  Reader reader(file);
  const Elf32_Ehdr header = read_header(reader);
  FirmwareImage image;
  image.entry = header.e_entry;
  image.segments = read_segments(reader, header);
  const auto identities = find_marked<Identity>(image.segments, kMark);
  if (!identities.empty()) {
    require_name(reader, identities.front().first.board, identities.size());
    read_ours(reader, identities.front().first, image);
  } else if (!image.segments.empty()) {
    read_own(reader, file.stem().string(), unstated, image);
  } else {
    reader.fail("has no bytes to load", Reader::kRemedy);
  }
  image.file = reader.take();
  return image;
}

}  // namespace tactree::cli
