#include "tactree/support/colour_file.hpp"

#include <fmt/core.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "tactree/core/crypto/sha512.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic = {'T', 'A', 'C', 'T', 'C', 'O', 'L', 0};
constexpr std::uint32_t kVersion = 1;
constexpr const char* kRemedy = "give the file that tactree build --colours wrote with this blob";

static_assert(std::endian::native == std::endian::little, "the file is written in memory order");

struct Header {
  std::array<std::uint8_t, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t points = 0;
  std::array<std::uint8_t, core::Sha512::kBytes> blob_hash{};
};
static_assert(sizeof(Header) == 80 && sizeof(PointColour) == 3);

Header header_of(std::span<const std::byte> blob, std::size_t points) {
  Header header;
  header.points = static_cast<std::uint32_t>(points);
  core::Sha512 hash;
  hash.update(blob);
  hash.finish(header.blob_hash);
  return header;
}

}  // namespace

void write_colours(const std::filesystem::path& file, std::span<const std::byte> blob,
                   std::span<const PointColour> colours) {
  const Header header = header_of(blob, colours.size());
  const std::span<const std::byte> begin = std::as_bytes(std::span(&header, 1));
  const std::span<const std::byte> rest = std::as_bytes(colours);
  std::vector<std::byte> bytes(begin.begin(), begin.end());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  write_file(file, std::span<const std::byte>(bytes));
}

std::vector<PointColour> read_colours(const std::filesystem::path& file, const BlobFile& blob,
                                      const std::string& name) {
  const std::string place = file.string();
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    refuse(place, std::string("cannot be read: ") + std::strerror(errno), kRemedy);
  }
  Header header;
  in.read(reinterpret_cast<char*>(&header), sizeof header);
  if (in.gcount() != static_cast<std::streamsize>(sizeof header) || header.magic != kMagic) {
    refuse(place, "is not a file of colours", kRemedy);
  }
  if (header.version != kVersion) {
    refuse(place, fmt::format("has version {}, this program reads {}", header.version, kVersion),
           "build it again with this version of tactree");
  }
  const std::uint32_t points = blob.view().point_count();
  if (header.points != points || header.blob_hash != header_of(blob.bytes(), points).blob_hash) {
    refuse(place, "belongs to another blob than " + name, kRemedy);
  }
  std::vector<PointColour> colours(points);
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(colours));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (in.gcount() != static_cast<std::streamsize>(bytes.size()) ||
      in.peek() != std::ifstream::traits_type::eof()) {
    refuse(place, fmt::format("its size is not that of the colours of {} points", points),
           "build it again, or copy it again from its source");
  }
  return colours;
}

}  // namespace tactree::support
