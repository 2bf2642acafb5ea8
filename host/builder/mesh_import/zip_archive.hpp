#pragma once
// The members of a zip archive. Sizes are checked against the archive before memory is allocated.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::builder {

class ZipArchive {
 public:
  /// `bytes` is the whole archive and must outlive this object. Throws ImportError.
  explicit ZipArchive(std::string_view bytes);

  /// True if the archive has this path, with or without a leading '/'. Ignores case.
  [[nodiscard]] bool contains(std::string_view path) const;
  /// Returns the unpacked member. Throws ImportError if it is missing or damaged.
  [[nodiscard]] std::string read(std::string_view path) const;
  /// Passes the unpacked member piece by piece to `take` until it returns false. Returns true if it
  /// took all pieces. Throws like read().
  [[nodiscard]] bool unpack(std::string_view path,
                            const std::function<bool(std::string_view)>& take) const;
  /// Paths of the members with this ending, in the order of the archive.
  [[nodiscard]] std::vector<std::string> with_ending(std::string_view ending) const;

 private:
  struct Member {
    std::string path;
    std::uint64_t method = 0;
    std::uint64_t packed = 0;
    std::uint64_t unpacked = 0;
    std::uint64_t header = 0;
    std::uint32_t checksum = 0;
  };
  [[nodiscard]] std::uint64_t number(std::uint64_t at, unsigned size) const;
  [[nodiscard]] std::uint64_t read_member(std::uint64_t at);
  void read_long_sizes(Member& member, std::uint64_t at, std::uint64_t end) const;
  [[nodiscard]] const Member* find(std::string_view path) const;
  [[nodiscard]] const Member& member(std::string_view path) const;
  [[nodiscard]] std::string_view packed_bytes(const Member& member) const;

  std::string_view bytes_;
  std::vector<Member> members_;
};

}  // namespace tactree::builder
