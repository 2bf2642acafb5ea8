#include "tactree/support/blob_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tactree/support/spooled_input.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
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

/// Checks size, magic and version of the header before the rest is read.
core::BlobStatus check_header(std::span<const std::byte> first) {
  core::BlobView none;
  const core::BlobStatus status = core::open_blob(first, none);
  const bool refused = status == core::BlobStatus::kTooShort ||
                       status == core::BlobStatus::kBadMagic ||
                       status == core::BlobStatus::kBadVersion;
  return refused ? status : core::BlobStatus::kOk;
}

[[noreturn]] void refuse_blob(const std::string& name, core::BlobStatus status,
                              const std::string& detail = "") {
  throw UserError(
      fmt::format("{}: refused: {}{} ({})", name, core::describe(status), detail, remedy(status)));
}

}  // namespace

BlobFile::BlobFile(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status kind = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(kind)) {
    throw UserError(
        fmt::format("{}: is a folder, not a blob (give the file in it)", file.string()));
  }
  if (std::filesystem::exists(kind) && !std::filesystem::is_regular_file(kind)) {
    throw UserError(
        fmt::format("{}: is a pipe or a device (a blob is read from a file: write it to one first)",
                    file.string()));
  }
  std::ifstream in(file, std::ios::binary);
  const std::uintmax_t size = in ? std::filesystem::file_size(file, error) : 0;
  if (!in || error) {
    throw UserError(fmt::format("{}: cannot be read: {} (give a blob: `tactree build` makes one)",
                                file.string(), error ? error.message() : std::strerror(errno)));
  }
  read_all(in, file.string(), size);
}

BlobFile BlobFile::named(const std::string& name) {
  if (name != kStandardInput) {
    return BlobFile(name);
  }
  BlobFile blob;
  blob.read_all(std::cin, kStandardInputName, std::nullopt);
  return blob;
}

BlobFile BlobFile::copy_of(std::span<const std::byte> bytes, const std::string& name) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  BlobFile blob;
  blob.read_all(in, name, bytes.size());
  return blob;
}

// Checks the header first, so that a large file of another kind is refused without reading it.
void BlobFile::read_all(std::istream& in, const std::string& name,
                        std::optional<std::uintmax_t> size) {
  read(in,
       std::min<std::uintmax_t>(size.value_or(sizeof(core::BlobHeader)), sizeof(core::BlobHeader)));
  const core::BlobStatus first = check_header(bytes());
  if (first != core::BlobStatus::kOk) {
    refuse_blob(name, first);
  }
  const std::uint32_t stated = stated_bytes();
  const auto refuse_size = [&](std::uintmax_t there, const char* more) {
    refuse_blob(
        name, core::BlobStatus::kBadSize,
        fmt::format(": its header states {} bytes, the file has {}{}", stated, there, more));
  };
  if (size && *size != stated) {
    refuse_size(*size, "");
  }
  const std::size_t there = read(in, stated);
  if (there < stated) {
    refuse_size(there, "");
  }
  if (in.peek() != std::istream::traits_type::eof()) {
    refuse_size(there, " and more");
  }
  const core::BlobStatus status = core::open_blob(bytes(), view_);
  if (status != core::BlobStatus::kOk) {
    refuse_blob(name, status);
  }
}

std::uint32_t BlobFile::stated_bytes() const {
  core::BlobHeader header{};
  std::memcpy(&header, words_.data(), sizeof header);
  return header.total_bytes;
}

std::size_t BlobFile::read(std::istream& in, std::uintmax_t size) {
  // Reads in blocks, because a stream may have fewer bytes than its header states.
  constexpr std::size_t kBlockBytes = std::size_t{1} << 26;
  while (size_ < size && in) {
    const std::size_t end = static_cast<std::size_t>(
        std::min<std::uintmax_t>(size, std::uintmax_t{size_} + kBlockBytes));
    words_.resize((end + 3) / 4);
    in.read(reinterpret_cast<char*>(words_.data()) + size_,
            static_cast<std::streamsize>(end - size_));
    size_ += static_cast<std::size_t>(in.gcount());
  }
  return size_;
}

std::vector<core::SurfacePoint> decode_points(const core::BlobView& view) {
  std::vector<core::SurfacePoint> points;
  points.reserve(view.point_count());
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    points.push_back(view.surface_point(leaf, index));
  });
  return points;
}

}  // namespace tactree::support
