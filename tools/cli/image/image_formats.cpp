#include "image/image_formats.hpp"

#include <elf.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "tactree/core/math/crc32.hpp"

namespace tactree::cli {
namespace {

constexpr std::byte kErased{0xFF};

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

template <class T>
void append(std::vector<std::byte>& to, const T& value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// ---- Intel HEX

void add_record(std::string& text, std::uint8_t type, std::uint16_t address,
                std::span<const std::byte> data) {
  std::uint8_t sum = static_cast<std::uint8_t>(data.size() + type + (address >> 8) + address);
  text += fmt::format(":{:02X}{:04X}{:02X}", data.size(), address, type);
  for (const std::byte byte : data) {
    text += fmt::format("{:02X}", std::to_integer<unsigned>(byte));
    sum = static_cast<std::uint8_t>(sum + std::to_integer<unsigned>(byte));
  }
  text += fmt::format("{:02X}\n", static_cast<std::uint8_t>(-sum));
}

std::vector<std::byte> big_endian(std::uint32_t value, std::uint32_t size) {
  std::vector<std::byte> bytes;
  for (std::uint32_t i = size; i > 0; --i) {
    bytes.push_back(static_cast<std::byte>(value >> (8U * (i - 1U))));
  }
  return bytes;
}

// ---- UF2

struct Uf2Block {
  std::uint32_t magic_0 = 0x0A324655;
  std::uint32_t magic_1 = 0x9E5D5157;
  std::uint32_t flags = 0;
  std::uint32_t address = 0;
  std::uint32_t size = 256;
  std::uint32_t number = 0;
  std::uint32_t count = 0;
  std::uint32_t family = 0;
  std::byte data[476] = {};
  std::uint32_t magic_end = 0x0AB16F30;
};
static_assert(sizeof(Uf2Block) == 512);
constexpr std::uint32_t kHasFamily = 0x2000;

// ---- DFU

#pragma pack(push, 1)
struct DfuSuffix {
  std::uint16_t device = 0xFFFF;
  std::uint16_t product = 0xFFFF;
  std::uint16_t vendor = 0xFFFF;
  std::uint16_t dfu_version = 0x0100;
  char mark[3] = {'U', 'F', 'D'};
  std::uint8_t length = 16;
};
#pragma pack(pop)
static_assert(sizeof(DfuSuffix) == 12);

// ---- ELF

template <class T>
std::vector<T> table_of(std::span<const std::byte> file, std::uint32_t offset, std::size_t count) {
  std::vector<T> table(count);
  if (offset <= file.size() && count * sizeof(T) <= file.size() - offset) {
    std::memcpy(table.data(), file.data() + offset, count * sizeof(T));
    return table;
  }
  return {};
}

/// Appends at a multiple of 4; returns the offset.
std::uint32_t append_part(std::vector<std::byte>& file, std::span<const std::byte> part) {
  file.resize((file.size() + 3) / 4 * 4);
  const auto offset = static_cast<std::uint32_t>(file.size());
  file.insert(file.end(), part.begin(), part.end());
  return offset;
}

/// Adds a section with the bytes of the blob, for tools that use only sections, such as gdb and
/// objcopy.
void add_section(std::vector<std::byte>& file, Elf32_Ehdr& header, const Segment& blob,
                 std::uint32_t blob_offset) {
  auto sections = table_of<Elf32_Shdr>(file, header.e_shoff, header.e_shnum);
  if (header.e_shstrndx >= sections.size()) {
    return;  // stripped of its sections
  }
  Elf32_Shdr& names = sections[header.e_shstrndx];
  auto text = table_of<char>(file, names.sh_offset, names.sh_size);
  Elf32_Shdr section{};
  section.sh_name = static_cast<Elf32_Word>(text.size());
  section.sh_type = SHT_PROGBITS;
  section.sh_flags = SHF_ALLOC;
  section.sh_addr = blob.address;
  section.sh_offset = blob_offset;
  section.sh_size = static_cast<Elf32_Word>(blob.bytes.size());
  section.sh_addralign = 4;
  const char name[] = ".blob";
  text.insert(text.end(), name, name + sizeof name);
  names.sh_offset = append_part(file, std::as_bytes(std::span(text)));
  names.sh_size = static_cast<Elf32_Word>(text.size());
  sections.push_back(section);
  header.e_shoff = append_part(file, std::as_bytes(std::span(sections)));
  header.e_shnum = static_cast<Elf32_Half>(sections.size());
}

}  // namespace

std::vector<std::byte> to_bin(std::span<const Segment> segments) {
  std::vector<std::byte> bin;
  for (const Segment& segment : segments) {
    bin.resize(segment.address - segments.front().address, kErased);
    bin.insert(bin.end(), segment.bytes.begin(), segment.bytes.end());
  }
  return bin;
}

std::vector<std::byte> to_hex(std::span<const Segment> segments, std::uint32_t entry) {
  std::string text;
  std::uint32_t upper = 0;
  for (const Segment& segment : segments) {
    for (std::size_t i = 0; i < segment.bytes.size();) {
      const auto address = static_cast<std::uint32_t>(segment.address + i);
      if (address >> 16 != upper) {
        upper = address >> 16;
        add_record(text, 4, 0, big_endian(upper, 2));
      }
      // A record ends at a multiple of 16, so that it does not cross into the next 64 KiB.
      const std::size_t size = std::min<std::size_t>(16 - address % 16, segment.bytes.size() - i);
      add_record(text, 0, static_cast<std::uint16_t>(address),
                 std::span(segment.bytes).subspan(i, size));
      i += size;
    }
  }
  add_record(text, 5, 0, big_endian(entry, 4));
  add_record(text, 1, 0, {});
  return bytes_of(text);
}

std::vector<std::byte> to_uf2(std::span<const Segment> segments, std::uint32_t family) {
  std::map<std::uint32_t, Uf2Block> blocks;
  for (const Segment& segment : segments) {
    for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
      const auto address = static_cast<std::uint32_t>(segment.address + i);
      auto [block, is_new] = blocks.try_emplace(address / 256 * 256);
      if (is_new) {
        std::fill_n(block->second.data, 256, kErased);
      }
      block->second.data[address % 256] = segment.bytes[i];
    }
  }
  std::vector<std::byte> file;
  std::uint32_t number = 0;
  for (auto& [address, block] : blocks) {
    block.flags = family == 0 ? 0 : kHasFamily;
    block.address = address;
    block.number = number++;
    block.count = static_cast<std::uint32_t>(blocks.size());
    block.family = family;
    append(file, block);
  }
  return file;
}

std::vector<std::byte> to_dfu(std::span<const Segment> segments, std::uint16_t vendor,
                              std::uint16_t product) {
  std::vector<std::byte> file = to_bin(segments);
  DfuSuffix suffix;
  suffix.vendor = vendor;
  suffix.product = product;
  append(file, suffix);
  append(file, ~core::crc32(file));  // DFU's checksum is not inverted at the end
  return file;
}

std::vector<std::byte> to_elf(std::span<const std::byte> file, const Segment& blob) {
  std::vector<std::byte> merged(file.begin(), file.end());
  Elf32_Ehdr header;
  std::memcpy(&header, merged.data(), sizeof header);
  const std::uint32_t blob_offset = append_part(merged, blob.bytes);

  auto segments = table_of<Elf32_Phdr>(merged, header.e_phoff, header.e_phnum);
  Elf32_Phdr segment{};
  segment.p_type = PT_LOAD;
  segment.p_offset = blob_offset;
  segment.p_vaddr = segment.p_paddr = blob.address;
  segment.p_filesz = segment.p_memsz = static_cast<Elf32_Word>(blob.bytes.size());
  segment.p_flags = PF_R;
  segment.p_align = 4;
  segments.push_back(segment);
  header.e_phoff = append_part(merged, std::as_bytes(std::span(segments)));
  header.e_phnum = static_cast<Elf32_Half>(segments.size());

  add_section(merged, header, blob, blob_offset);
  std::memcpy(merged.data(), &header, sizeof header);
  return merged;
}

}  // namespace tactree::cli
