#pragma once
// Sequential, buffered reading of a regular file, by bytes or by lines.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::builder {

class InputFile {
 public:
  /// Maximum length of a line, and of a contiguous run of bytes for peek().
  static constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;
  static constexpr std::size_t kMaxPeekBytes = std::size_t{1} << 26;

  /// `label` is the name in messages; if it is empty, the path is used. Throws ReadError if `path`
  /// is missing, unreadable, empty or not a regular file.
  explicit InputFile(const std::filesystem::path& path,
                     std::function<void(double)> progress = nullptr, std::string label = "");
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Offset of the next unread byte.
  [[nodiscard]] std::uint64_t offset() const { return buffer_offset_ + begin_; }
  [[nodiscard]] std::uint64_t remaining() const { return size_ - offset(); }

  /// Returns the next bytes: at least `wanted` (at most kMaxPeekBytes) unless the file ends
  /// earlier. They are valid until the next call of any member function.
  [[nodiscard]] std::string_view peek(std::size_t wanted) {
    if (end_ - begin_ < wanted) fill(wanted);
    return {buffer_.data() + begin_, end_ - begin_};
  }
  /// Skips bytes returned by peek().
  void consume(std::size_t count) { begin_ += count; }
  /// Skips any number of bytes, at most to the end of the file.
  void skip(std::uint64_t count);

  /// Skips zero bytes, with which some programs pad the end of a file. Returns true if no other
  /// bytes follow.
  [[nodiscard]] bool only_zeros_left();

  /// Reads the next line, without a byte order mark at the beginning of the file and without its
  /// line end ("\n", "\r\n", or "\r" in a file that has no "\n"). Returns false at the end of the
  /// file. Throws ReadError for a line above kMaxLineBytes.
  [[nodiscard]] bool next_line(std::string_view& line);
  /// Number of the last line read, from 1.
  [[nodiscard]] std::uint64_t line_number() const { return line_number_; }
  /// "line 12", for messages.
  [[nodiscard]] std::string line_place() const;

  /// Returns to the first byte.
  void rewind();

 private:
  void fill(std::size_t wanted);
  void find_line_end_character();

  std::string name_;
  std::function<void(double)> progress_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::uint64_t buffer_offset_ = 0;  // file offset of buffer_[0]
  std::size_t begin_ = 0;            // unread part of buffer_
  std::size_t end_ = 0;
  std::uint64_t line_number_ = 0;
  char line_end_ = '\0';  // unknown until the first line is read
};

}  // namespace tactree::builder
