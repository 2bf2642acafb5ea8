#include "blob_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "command.hpp"

namespace tactree::cli {
namespace {

const char* remedy(core::BlobStatus status) {
  switch (status) {
    case core::BlobStatus::kTooShort:
    case core::BlobStatus::kBadMagic:
      return "give the file that `tactree build -o` wrote; a scan is turned into one by "
             "`tactree build`";
    case core::BlobStatus::kBadVersion:
      return "build it again with this version of tactree";
    default:
      return "copy it again from its source, or build it again from the scan";
  }
}

/// What the first bytes of a file of `size` bytes tell, before the rest is read.
core::BlobStatus check_header(std::span<const std::byte> first, std::uintmax_t size) {
  core::BlobView none;
  const core::BlobStatus status = core::open_blob(first, none);
  if (status == core::BlobStatus::kTooShort || status == core::BlobStatus::kBadMagic ||
      status == core::BlobStatus::kBadVersion) {
    return status;
  }
  core::BlobHeader header{};
  std::memcpy(&header, first.data(), sizeof header);
  return header.total_bytes == size ? core::BlobStatus::kOk : core::BlobStatus::kBadSize;
}

[[noreturn]] void refuse(const std::filesystem::path& file, core::BlobStatus status,
                         const std::string& detail) {
  throw CommandError(fmt::format("{}: refused: {}{} ({})", file.string(), core::describe(status),
                                 detail, remedy(status)));
}

}  // namespace

BlobFile::BlobFile(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status kind = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(kind)) {
    throw CommandError(
        fmt::format("{}: is a folder, not a blob (give the file in it)", file.string()));
  }
  if (std::filesystem::exists(kind) && !std::filesystem::is_regular_file(kind)) {
    throw CommandError(
        fmt::format("{}: is a pipe or a device (a blob is read from a file: write it to one first)",
                    file.string()));
  }
  std::ifstream in(file, std::ios::binary);
  const std::uintmax_t size = in ? std::filesystem::file_size(file, error) : 0;
  if (!in || error) {
    throw CommandError(
        fmt::format("{}: cannot be read: {} (give a blob: `tactree build` makes one)",
                    file.string(), error ? error.message() : std::strerror(errno)));
  }
  // The header first: a large file of another kind is refused without reading it.
  read(in, file, std::min<std::uintmax_t>(size, sizeof(core::BlobHeader)));
  const core::BlobStatus first = check_header(bytes(), size);
  if (first != core::BlobStatus::kOk) {
    refuse(file, first,
           first == core::BlobStatus::kBadSize
               ? fmt::format(": its header states {} bytes, the file has {}", stated_bytes(), size)
               : "");
  }
  read(in, file, size);
  const core::BlobStatus status = core::open_blob(bytes(), view_);
  if (status != core::BlobStatus::kOk) {
    refuse(file, status, "");
  }
}

std::uint32_t BlobFile::stated_bytes() const {
  core::BlobHeader header{};
  std::memcpy(&header, words_.data(), sizeof header);
  return header.total_bytes;
}

void BlobFile::read(std::istream& in, const std::filesystem::path& file, std::uintmax_t size) {
  const std::size_t begin = size_;
  size_ = static_cast<std::size_t>(size);
  words_.resize((size_ + 3) / 4);
  if (!in.read(reinterpret_cast<char*>(words_.data()) + begin,
               static_cast<std::streamsize>(size_ - begin))) {
    throw CommandError(
        fmt::format("{}: ended while it was read (wait until it is written)", file.string()));
  }
}

std::vector<core::SurfacePoint> decode_points(const core::BlobView& view) {
  std::vector<core::SurfacePoint> points;
  points.reserve(view.point_count());
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    points.push_back(view.surface_point(leaf, index));
  });
  return points;
}

}  // namespace tactree::cli
