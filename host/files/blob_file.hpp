#pragma once
// A blob read from a file and checked.

#include <cstdint>
#include <filesystem>
#include <istream>
#include <span>
#include <vector>

#include "tactree/core/blob.hpp"

namespace tactree::cli {

/// Owns the bytes; view() and bytes() are valid during its lifetime.
class BlobFile {
 public:
  /// Reads and checks, the header before the rest. Throws CommandError that names the file, the
  /// cause and the remedy.
  explicit BlobFile(const std::filesystem::path& file);

  [[nodiscard]] const core::BlobView& view() const { return view_; }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(words_)).first(size_);
  }

 private:
  /// Reads on, up to `size` bytes of the file.
  void read(std::istream& in, const std::filesystem::path& file, std::uintmax_t size);
  [[nodiscard]] std::uint32_t stated_bytes() const;

  std::vector<std::uint32_t> words_;  // blobs start on a 4-byte boundary
  std::size_t size_ = 0;
  core::BlobView view_;
};

/// Every point of a blob, decoded, by index.
[[nodiscard]] std::vector<core::SurfacePoint> decode_points(const core::BlobView& view);

}  // namespace tactree::cli
