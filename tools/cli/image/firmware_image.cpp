#include "image/firmware_image.hpp"

#include <elf.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>

#include "tactree/core/math/crc32.hpp"
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

Identity find_identity(const Reader& reader, const std::vector<Segment>& segments) {
  Identity identity{};
  int found = 0;
  for (const Segment& segment : segments) {
    for (std::size_t i = 0; i + sizeof identity <= segment.bytes.size(); i += 4) {
      if (std::memcmp(segment.bytes.data() + i, kMark, sizeof kMark) == 0) {
        std::memcpy(&identity, segment.bytes.data() + i, sizeof identity);
        ++found;
      }
    }
  }
  if (found != 1 || identity.board[sizeof identity.board - 1] != '\0') {
    reader.fail(found == 0
                    ? "not an image of Tactree: it does not name its board"
                    : "it has several identification records, or one with a malformed board name",
                Reader::kRemedy);
  }
  return identity;
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

}  // namespace

FirmwareImage read_firmware(const std::filesystem::path& file) {
  Reader reader(file);
  const Elf32_Ehdr header = read_header(reader);
  FirmwareImage image;
  image.entry = header.e_entry;
  image.segments = read_segments(reader, header);
  const Identity identity = find_identity(reader, image.segments);
  image.board = identity.board;
  image.code_begin = identity.code_begin;
  image.code_end = identity.code_end;
  image.blob_begin = identity.blob_begin;
  image.blob_end = identity.blob_end;
  image.uf2_family = identity.uf2_family;
  check_ranges(reader, image);
  check_checksum(reader, identity, image.segments);
  image.file = reader.take();
  return image;
}

}  // namespace tactree::cli
