#pragma once
// The points of one scan of an E57 file: packets, each with a chunk of the stream of every field.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "e57_index.hpp"
#include "e57_pages.hpp"

namespace tactree::builder {

class E57Streams {
 public:
  /// Reads the header of the section. Throws ReadError, also if the section is too short for the
  /// points. `file` is the name in messages.
  E57Streams(E57Pages& pages, const E57Scan& scan, const std::string& file);

  /// Calls `add` with the values of all fields for each point. Throws ReadError.
  void read(const std::function<void(const std::vector<double>& values)>& add);

 private:
  struct Stream {
    std::vector<char> bytes;  // from the first unread number on, then kPadding
    std::uint64_t bit = 0;    // position of the first unread number
  };

  void read_header();
  void check_room() const;
  bool read_packet();
  void read_data_packet(std::uint64_t bytes);
  [[nodiscard]] std::uint64_t complete_points() const;
  [[nodiscard]] double next(std::size_t field);
  void discard_read();
  [[noreturn]] void fail(const std::string& cause) const;

  E57Pages& pages_;
  const E57Scan& scan_;
  const std::string& file_;
  std::uint64_t data_ = 0;  // logical offset of the next packet
  std::uint64_t end_ = 0;   // logical end of the section
  std::vector<Stream> streams_;
  std::vector<char> packet_;
};

}  // namespace tactree::builder
