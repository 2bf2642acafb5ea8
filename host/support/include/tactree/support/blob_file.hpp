#pragma once
// A blob read from a file and checked.

#include <cstdint>
#include <filesystem>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::support {

/// Owns the bytes; view() and bytes() are valid during its lifetime.
class BlobFile {
 public:
  /// Reads and checks the blob, its header first. Throws UserError that names the file, the cause
  /// and the hint.
  explicit BlobFile(const std::filesystem::path& file);

  /// Reads the blob that a command line names, where "-" is standard input. Throws UserError.
  [[nodiscard]] static BlobFile named(const std::string& name);

  /// Copies and checks a blob; `name` is that of messages. Throws UserError.
  [[nodiscard]] static BlobFile copy_of(std::span<const std::byte> bytes, const std::string& name);

  [[nodiscard]] const core::BlobView& view() const { return view_; }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(words_)).first(size_);
  }

 private:
  BlobFile() = default;
  /// Reads and checks `size` bytes, or the number that the header states if `size` is empty.
  void read_all(std::istream& in, const std::string& name, std::optional<std::uintmax_t> size);
  /// Continues to read until `size` bytes in total, or the end. Returns the total number.
  std::size_t read(std::istream& in, std::uintmax_t size);
  [[nodiscard]] std::uint32_t stated_bytes() const;

  std::vector<std::uint32_t> words_;  // blobs start on a 4-byte boundary
  std::size_t size_ = 0;
  core::BlobView view_;
};

/// Decodes all points of a blob, in the order of their index.
[[nodiscard]] std::vector<core::SurfacePoint> decode_points(const core::BlobView& view);

}  // namespace tactree::support
