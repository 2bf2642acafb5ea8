#include "mesh_import/zip_archive.hpp"

#include <zlib.h>

#include <algorithm>
#include <cctype>

#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {
namespace {

constexpr std::string_view kEnd = "PK\x05\x06";
constexpr std::string_view kEnd64 = "PK\x06\x06";
constexpr std::string_view kMember = "PK\x01\x02";
constexpr std::string_view kLocal = "PK\x03\x04";
constexpr std::uint64_t kEndBytes = 22;
constexpr std::uint64_t kLocator64Bytes = 20;
constexpr std::uint64_t kMemberBytes = 46;
constexpr std::uint64_t kLocalBytes = 30;
constexpr std::uint64_t kAbsent = 0xffffffff;  // the number is in the extra field
constexpr std::uint64_t kMaxRatio = 1040;      // above the maximum ratio of deflate, 1032

[[noreturn]] void fail(const std::string& cause) {
  throw ImportError("its zip archive is damaged or was cut off: " + cause);
}

bool equal(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

std::string inflated(std::string_view packed, std::uint64_t size, const std::string& path) {
  if (size / kMaxRatio > packed.size()) {
    fail("\"" + path + "\" states a size that its bytes cannot have");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) {
    throw std::bad_alloc();
  }
  stream.next_in =
      reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // NOLINT: not written
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int result = ::inflate(&stream, Z_FINISH);
  const std::uint64_t written = stream.total_out;
  ::inflateEnd(&stream);
  if (result != Z_STREAM_END || written != size) {
    fail("\"" + path + "\" cannot be unpacked");
  }
  return bytes;
}

}  // namespace

ZipArchive::ZipArchive(std::string_view bytes) : bytes_(bytes) {
  const std::size_t end = bytes_.rfind(kEnd);
  if (end == std::string_view::npos || bytes_.size() - end < kEndBytes) {
    fail("its directory is missing");
  }
  std::uint64_t count = number(end + 10, 2);
  std::uint64_t at = number(end + 16, 4);
  if (end >= kLocator64Bytes && number(end - kLocator64Bytes, 4) == 0x07064b50) {
    const std::uint64_t end64 = number(end - kLocator64Bytes + 8, 8);
    if (end64 < bytes_.size() &&
        bytes_.substr(static_cast<std::size_t>(end64)).starts_with(kEnd64)) {
      count = number(end64 + 32, 8);
      at = number(end64 + 48, 8);
    }
  }
  for (std::uint64_t i = 0; i < count && at < end; ++i) {
    at = read_member(at);
  }
  if (members_.empty()) {
    fail("it contains no files");
  }
}

std::uint64_t ZipArchive::number(std::uint64_t at, unsigned size) const {
  if (at > bytes_.size() || size > bytes_.size() - at) {
    fail("it ends inside a header");
  }
  std::uint64_t value = 0;
  for (unsigned k = 0; k < size; ++k) {
    const auto byte = static_cast<unsigned char>(bytes_[static_cast<std::size_t>(at + k)]);
    value |= std::uint64_t{byte} << (8 * k);
  }
  return value;
}

/// Returns the position of the next entry of the directory.
std::uint64_t ZipArchive::read_member(std::uint64_t at) {
  if (at > bytes_.size() || !bytes_.substr(static_cast<std::size_t>(at)).starts_with(kMember)) {
    fail("an entry of its directory is missing");
  }
  Member member;
  member.method = number(at + 10, 2);
  member.checksum = static_cast<std::uint32_t>(number(at + 16, 4));
  member.packed = number(at + 20, 4);
  member.unpacked = number(at + 24, 4);
  member.header = number(at + 42, 4);
  const std::uint64_t name = number(at + 28, 2);
  const std::uint64_t extra = number(at + 30, 2);
  const std::uint64_t comment = number(at + 32, 2);
  (void)number(at + kMemberBytes + name + extra + comment, 0);  // throws if not inside the archive
  member.path =
      bytes_.substr(static_cast<std::size_t>(at + kMemberBytes), static_cast<std::size_t>(name));
  read_long_sizes(member, at + kMemberBytes + name, at + kMemberBytes + name + extra);
  members_.push_back(std::move(member));
  return at + kMemberBytes + name + extra + comment;
}

/// Zip64 stores the numbers that are kAbsent in the entry as numbers of eight bytes, in this order.
void ZipArchive::read_long_sizes(Member& member, std::uint64_t at, std::uint64_t end) const {
  constexpr std::uint64_t kLongSizes = 1;
  while (at + 4 <= end) {
    const std::uint64_t kind = number(at, 2);
    const std::uint64_t field_end = at + 4 + number(at + 2, 2);
    std::uint64_t from = at + 4;
    for (std::uint64_t* value : {&member.unpacked, &member.packed, &member.header}) {
      if (kind != kLongSizes || *value != kAbsent || from + 8 > std::min(field_end, end)) {
        continue;
      }
      *value = number(from, 8);
      from += 8;
    }
    at = field_end;
  }
}

const ZipArchive::Member* ZipArchive::find(std::string_view path) const {
  if (path.starts_with('/')) {
    path.remove_prefix(1);
  }
  const auto found = std::find_if(members_.begin(), members_.end(),
                                  [&](const Member& member) { return equal(member.path, path); });
  return found == members_.end() ? nullptr : &*found;
}

bool ZipArchive::contains(std::string_view path) const { return find(path) != nullptr; }

std::string ZipArchive::first_with_ending(std::string_view ending) const {
  for (const Member& member : members_) {
    if (member.path.size() > ending.size() &&
        equal(std::string_view(member.path).substr(member.path.size() - ending.size()), ending)) {
      return member.path;
    }
  }
  return {};
}

std::string ZipArchive::read(std::string_view path) const {
  const Member* member = find(path);
  if (member == nullptr) {
    throw ImportError("its part \"" + std::string(path.substr(0, 100)) + "\" is missing");
  }
  const std::uint64_t local = member->header;
  if (local > bytes_.size() ||
      !bytes_.substr(static_cast<std::size_t>(local)).starts_with(kLocal)) {
    fail("\"" + member->path + "\" is not at the position that its directory states");
  }
  const std::uint64_t begin = local + kLocalBytes + number(local + 26, 2) + number(local + 28, 2);
  if (begin > bytes_.size() || member->packed > bytes_.size() - begin) {
    fail("\"" + member->path + "\" extends beyond the end of the file");
  }
  const std::string_view packed =
      bytes_.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(member->packed));
  if (member->method != 0 && member->method != 8) {
    throw ImportError("\"" + member->path + "\" is compressed with a method that is not supported");
  }
  std::string bytes =
      member->method == 8 ? inflated(packed, member->unpacked, member->path) : std::string(packed);
  const auto checksum = ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (checksum != member->checksum) {
    fail("the checksum of \"" + member->path + "\" is wrong");
  }
  return bytes;
}

}  // namespace tactree::builder
