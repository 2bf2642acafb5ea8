#pragma once
// The pages of an E57 file: 1024 bytes, of which the last four are the checksum of the others.
// Physical offsets count all bytes of the file, logical offsets leave out the checksums.

#include <array>
#include <cstdint>
#include <string>

#include "input_file.hpp"

namespace tactree::builder {

class E57Pages {
 public:
  static constexpr std::uint64_t kPageBytes = 1024;
  static constexpr std::uint64_t kDataBytes = 1020;

  explicit E57Pages(InputFile& file) : file_(file) {}

  /// Logical bytes of the whole file.
  [[nodiscard]] std::uint64_t size() const { return file_.size() / kPageBytes * kDataBytes; }
  [[nodiscard]] std::uint64_t offset() const { return page_ * kDataBytes + at_; }

  /// Returns the logical offset of a physical one. Throws ReadError if there is no data; `what`
  /// names the data in the message, e.g. "the points of scan 2".
  [[nodiscard]] std::uint64_t to_logical(std::uint64_t physical, const std::string& what) const;

  /// Sets the logical offset of the next read().
  void seek(std::uint64_t logical);
  /// Copies the next bytes. Throws ReadError at the end of the file and for a wrong checksum.
  void read(char* to, std::size_t count);

 private:
  void load();

  InputFile& file_;
  std::uint64_t page_ = 0;
  std::uint64_t at_ = 0;  // offset in data_
  bool loaded_ = false;
  std::array<char, kDataBytes> data_{};
};

}  // namespace tactree::builder
