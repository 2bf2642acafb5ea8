// The binary form of OFF: the keyword and "BINARY" on a line, then big-endian numbers of four
// bytes: counts, points, and faces with a colour each.

#include <fmt/format.h>

#include "number.hpp"
#include "readers.hpp"
#include "scalar.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kNumberBytes = 4;
constexpr std::uint64_t kLeastFaceBytes = 2 * kNumberBytes;  // no vertices, no colour

class OffBinaryReader {
 public:
  OffBinaryReader(InputFile& file, const ReadOptions& options)
      : file_(file), builder_(file.name(), options, "byte") {}

  Scan read() {
    std::string_view line;
    if (!file_.next_line(line)) fail("the file ends before its counts");
    const std::string_view keyword = take_word(line);
    has_normals_ = keyword.find('N') != std::string_view::npos;
    has_colours_ = keyword.find('C') != std::string_view::npos;
    has_texture_ = keyword.starts_with("ST");
    if (has_normals_) builder_.use_normals();
    if (has_colours_) builder_.use_colours(ColourRange::kAuto);
    const std::uint64_t points = read_count("points");
    const std::uint64_t faces = read_count("faces");
    (void)read_count("edges");
    check_room(points, faces);
    builder_.reserve_points(points);
    builder_.limit_face_indices(points);
    for (std::uint64_t i = 0; i < points; ++i) read_point();
    for (std::uint64_t i = 0; i < faces; ++i) read_face();
    return builder_.finish("OFF binary");
  }

 private:
  std::int32_t read_integer() {
    const std::string_view bytes = file_.peek(kNumberBytes);
    if (bytes.size() < kNumberBytes) fail("the file ends too early");
    const auto value = load_scalar<true>(bytes.data(), ScalarType::kInt32);
    file_.consume(kNumberBytes);
    return static_cast<std::int32_t>(value);
  }

  std::uint64_t read_count(const char* what) {
    const std::int32_t value = read_integer();
    if (value < 0) fail(fmt::format("{} is not a number of {}", value, what));
    return static_cast<std::uint64_t>(value);
  }

  [[nodiscard]] std::uint64_t point_bytes() const {
    return kNumberBytes *
           (3U + (has_normals_ ? 3U : 0U) + (has_colours_ ? 4U : 0U) + (has_texture_ ? 2U : 0U));
  }

  void check_room(std::uint64_t points, std::uint64_t faces) const {
    if (points == 0) fail("the file contains no points: its header declares 0 points");
    const std::uint64_t room = file_.remaining() / point_bytes();
    if (points > room) {
      fail(fmt::format("{} points are declared, the file has room for {}", points, room));
    }
    const std::uint64_t face_room = (file_.remaining() - points * point_bytes()) / kLeastFaceBytes;
    if (faces > face_room) {
      fail(fmt::format("{} faces are declared, the file has room for {}", faces, face_room));
    }
  }

  void read_point() {
    const std::string_view bytes = file_.peek(static_cast<std::size_t>(point_bytes()));
    if (bytes.size() < point_bytes()) fail("the file ends too early");
    const char* at = bytes.data();
    PointRow point{};
    const auto read_three = [&](Slot first) {
      for (std::size_t k = 0; k < 3; ++k, at += kNumberBytes) {
        point[first + k] = load_scalar<true>(at, ScalarType::kFloat32);
      }
    };
    read_three(kX);
    if (has_normals_) read_three(kNx);
    if (has_colours_) read_three(kRed);
    builder_.add_point(point);
    file_.consume(static_cast<std::size_t>(point_bytes()));
  }

  void read_face() {
    const std::uint64_t place = file_.offset();
    const std::uint64_t corners = read_count("corners");
    if (corners > file_.remaining() / kNumberBytes) {
      fail(fmt::format("a face of {} vertices is declared, there is room for {}", corners,
                       file_.remaining() / kNumberBytes));
    }
    corners_.clear();
    for (std::uint64_t i = 0; i < corners; ++i) corners_.push_back(read_integer());
    const std::uint64_t colours = read_count("colours");
    if (colours > file_.remaining() / kNumberBytes) fail("the file ends too early");
    file_.skip(colours * kNumberBytes);
    builder_.add_face(corners_, place);
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), fmt::format("byte {}", file_.offset()), cause, kCopyAgain);
  }

  InputFile& file_;
  ScanBuilder builder_;
  bool has_normals_ = false;
  bool has_colours_ = false;
  bool has_texture_ = false;
  std::vector<std::int64_t> corners_;
};

}  // namespace

Scan read_off_binary(InputFile& file, const ReadOptions& options) {
  return OffBinaryReader(file, options).read();
}

}  // namespace tactree::builder
