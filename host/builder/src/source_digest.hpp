#pragma once
// SHA-256 of the input files, computed while they are read.

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <future>
#include <span>

namespace tactree::builder {

using Sha256Digest = std::array<std::uint8_t, 32>;

class SourceDigest {
 public:
  /// Starts the computation, in a separate thread if `in_background`. `files` must outlive it.
  SourceDigest(std::span<const std::filesystem::path> files, bool in_background);
  /// Stops an unfinished computation.
  ~SourceDigest();
  SourceDigest(const SourceDigest&) = delete;
  SourceDigest& operator=(const SourceDigest&) = delete;

  /// Returns the digest of the bytes of all files, one file after the other. Anything but a regular
  /// file counts as empty, because read_scan() refuses it. Call once.
  [[nodiscard]] Sha256Digest get() { return digest_.get(); }

 private:
  std::atomic<bool> stop_{false};
  std::future<Sha256Digest> digest_;
};

}  // namespace tactree::builder
