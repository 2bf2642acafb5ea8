#include "blob_file.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "command.hpp"

namespace tactree::cli {
namespace {

constexpr std::uintmax_t kLargestBlob = 0xFFFFFFFFU;

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

}  // namespace

BlobFile::BlobFile(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw CommandError(
        fmt::format("{}: is a folder, not a blob (give the file in it)", file.string()));
  }
  std::ifstream in(file, std::ios::binary);
  const std::uintmax_t size = in ? std::filesystem::file_size(file, error) : 0;
  if (!in || error) {
    throw CommandError(
        fmt::format("{}: cannot be read: {} (give a blob: `tactree build` makes one)",
                    file.string(), error ? error.message() : std::strerror(errno)));
  }
  if (size > kLargestBlob) {
    throw CommandError(
        fmt::format("{}: {} bytes: larger than any blob (give the file that `tactree build` wrote)",
                    file.string(), size));
  }
  size_ = static_cast<std::size_t>(size);
  words_.resize((size_ + 3) / 4);
  if (!in.read(reinterpret_cast<char*>(words_.data()), static_cast<std::streamsize>(size_))) {
    throw CommandError(
        fmt::format("{}: ended while it was read (wait until it is written)", file.string()));
  }
  const core::BlobStatus status = core::open_blob(bytes(), view_);
  if (status != core::BlobStatus::kOk) {
    throw CommandError(
        fmt::format("{}: refused: {} ({})", file.string(), core::describe(status), remedy(status)));
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
