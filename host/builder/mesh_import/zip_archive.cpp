#include "mesh_import/zip_archive.hpp"

#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

#include "mesh_import/imported_mesh.hpp"
#include "src/readers/number.hpp"

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
constexpr std::uint64_t kAbsent = 0xffffffff;     // the number is in the extra field
constexpr std::uint64_t kMaxDeflateRatio = 1040;  // above the maximum ratio of deflate, 1032

[[noreturn]] void fail(const std::string& cause) {
  throw ImportError("its zip archive is damaged or was cut off: " + cause);
}

using Take = std::function<bool(std::string_view)>;

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

/// Returns false if `take` did, like inflate().
bool pass_on(std::string_view bytes, const Take& take) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kPieceBytes, bytes.size()))) {
    if (!take(bytes.substr(0, kPieceBytes))) return false;
  }
  return true;
}

/// Unpacks piece by piece. Returns false if `take` did.
bool inflate(std::string_view packed, std::uint64_t size, const std::string& path,
             const Take& take) {
  if (size / kMaxDeflateRatio > packed.size()) {
    fail("\"" + path + "\" states a size that its bytes cannot have");
  }
  std::string piece(kPieceBytes, '\0');
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<z_stream, int (*)(z_streamp)> end(&stream, ::inflateEnd);
  std::uint64_t written = 0;
  int result = Z_OK;
  while (result == Z_OK) {
    if (stream.avail_in == 0) {  // its length may exceed the type of avail_in
      const std::string_view next = packed.substr(0, std::size_t{1} << 30);
      packed.remove_prefix(next.size());
      stream.next_in =
          reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));  // NOLINT: not written
      stream.avail_in = static_cast<uInt>(next.size());
    }
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    result = ::inflate(&stream, Z_NO_FLUSH);
    const std::size_t bytes = piece.size() - stream.avail_out;
    written += bytes;
    if (written > size) break;
    if (bytes > 0 && !take(std::string_view(piece).substr(0, bytes))) return false;
  }
  if (result != Z_STREAM_END || written != size) {
    fail("\"" + path + "\" cannot be unpacked");
  }
  return true;
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
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& member) {
    return equal_ignoring_case(member.path, path);
  });
  return found == members_.end() ? nullptr : &*found;
}

bool ZipArchive::contains(std::string_view path) const { return find(path) != nullptr; }

std::vector<std::string> ZipArchive::with_ending(std::string_view ending) const {
  std::vector<std::string> paths;
  for (const Member& member : members_) {
    if (member.path.size() > ending.size() &&
        equal_ignoring_case(
            std::string_view(member.path).substr(member.path.size() - ending.size()), ending)) {
      paths.push_back(member.path);
    }
  }
  return paths;
}

const ZipArchive::Member& ZipArchive::member(std::string_view path) const {
  const Member* const found = find(path);
  if (found == nullptr) {
    throw ImportError("its part \"" + std::string(path.substr(0, 100)) + "\" is missing");
  }
  if (found->method != 0 && found->method != 8) {
    throw ImportError("\"" + found->path + "\" is compressed with a method that is not supported");
  }
  return *found;
}

std::string_view ZipArchive::packed_bytes(const Member& member) const {
  const std::uint64_t local = member.header;
  if (local > bytes_.size() ||
      !bytes_.substr(static_cast<std::size_t>(local)).starts_with(kLocal)) {
    fail("\"" + member.path + "\" is not at the position that its directory states");
  }
  const std::uint64_t begin = local + kLocalBytes + number(local + 26, 2) + number(local + 28, 2);
  if (begin > bytes_.size() || member.packed > bytes_.size() - begin) {
    fail("\"" + member.path + "\" extends beyond the end of the file");
  }
  return bytes_.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(member.packed));
}

bool ZipArchive::unpack(std::string_view path, const Take& take) const {
  const Member& found = member(path);
  const std::string_view packed = packed_bytes(found);
  uLong checksum = ::crc32_z(0, nullptr, 0);
  const Take count = [&](std::string_view bytes) {
    checksum = ::crc32_z(checksum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return take(bytes);
  };
  const bool all = found.method == 8 ? inflate(packed, found.unpacked, found.path, count)
                                     : pass_on(packed, count);
  if (all && checksum != found.checksum) {
    fail("the checksum of \"" + found.path + "\" is wrong");
  }
  return all;
}

std::string ZipArchive::read(std::string_view path) const {
  const Member& found = member(path);
  const std::string_view packed = packed_bytes(found);
  if (found.unpacked / kMaxDeflateRatio <= packed.size()) {
    std::string bytes;
    bytes.reserve(static_cast<std::size_t>(found.unpacked));
    (void)unpack(path, [&](std::string_view piece) {
      bytes += piece;
      return true;
    });
    return bytes;
  }
  fail("\"" + found.path + "\" states a size that its bytes cannot have");
}

}  // namespace tactree::builder
