#pragma once
// Helpers of the targets for file readers.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace tactree::fuzz {

// std::abort() in every build type, unlike an assertion.
inline void require(bool good, const char* sentence) {
  if (!good) {
    std::fprintf(stderr, "finding: %s\n", sentence);
    std::abort();
  }
}

/// Requires the form "file: cause (hint)".
inline void require_reason(std::string_view text, std::string_view file) {
  if (text.size() <= file.size() + 10 || text.substr(0, file.size()) != file) {
    std::fprintf(stderr, "%.*s\n", static_cast<int>(text.size()), text.data());
  }
  require(text.substr(0, file.size()) == file, "a refusal that does not begin with the file");
  require(text.size() > file.size() + 10, "a refusal without a reason");
}

/// A file in memory.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size)
      : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "no file in memory can be made");
    require(::write(descriptor_, data, size) == static_cast<ssize_t>(size), "it cannot be written");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::filesystem::path path() const {
    return "/proc/self/fd/" + std::to_string(descriptor_);
  }

 private:
  int descriptor_;
};

/// A folder of this process.
class Folder {
 public:
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "fuzz-XXXXXX";
    require(::mkdtemp(name.data()) != nullptr, "no folder can be made");
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tactree::fuzz
