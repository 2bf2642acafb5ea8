// STL (stereolithography), text and binary. Every triangle repeats its vertices; bitwise equal ones
// become one point. assimp is not used here, because it trusts the count in the file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "number.hpp"
#include "readers.hpp"
#include "scalar.hpp"
#include "scan_builder.hpp"
#include "stl_layout.hpp"
#include "vertex_welder.hpp"

namespace tactree::builder {
namespace {

constexpr const char* kCopyOrExportAgain = "copy or export it again";
constexpr std::size_t kStlSampleBytes = 1024;

std::uint32_t count_in(std::string_view head) {
  return load_bits<std::uint32_t, false>(head.data() + kStlCountByte);
}

std::array<float, 3> load_vector(const char* from) {
  std::array<float, 3> vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    vector[i] = static_cast<float>(load_scalar<false>(from + 4 * i, ScalarType::kFloat32));
  }
  return vector;
}

bool is_plausible_triangle(const char* from) {
  constexpr float kFarthest = 1e9F;
  const auto normal = load_vector(from);
  const float length = std::hypot(normal[0], normal[1], normal[2]);
  if (!(length == 0.0F || std::abs(length - 1.0F) < 0.05F)) return false;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (const float coordinate : load_vector(from + kStlCornersByte + 12 * corner)) {
      const float size = std::abs(coordinate);
      if (!(size < kFarthest) || (size > 0.0F && size < 1e-30F)) return false;
    }
  }
  return true;
}

/// Adds triangles to a builder. Merges equal vertices.
class Triangles {
 public:
  Triangles(const InputFile& file, const ReadOptions& options, const char* place_unit)
      : builder_(file.name(), options, place_unit) {}

  void add(const std::array<VertexWelder::Position, 3>& corners, std::uint64_t place) {
    std::array<std::int64_t, 3> face{};
    std::transform(corners.begin(), corners.end(), face.begin(),
                   [&](const VertexWelder::Position& corner) { return welder_.add(corner); });
    builder_.add_face(face, place);
    if (welder_.bytes() > charged_) {
      builder_.charge(welder_.bytes() - charged_);
      charged_ = welder_.bytes();
    }
  }

  Scan finish(const std::string& format) {
    builder_.reserve_points(welder_.positions().size());
    PointRow row{};
    for (const VertexWelder::Position& position : welder_.positions()) {
      std::copy(position.begin(), position.end(), row.begin());
      builder_.add_point(row);
    }
    return builder_.finish(format);
  }

  ScanBuilder& builder() { return builder_; }

 private:
  ScanBuilder builder_;
  VertexWelder welder_;
  std::uint64_t charged_ = 0;
};

class AsciiReader {
 public:
  AsciiReader(InputFile& file, const ReadOptions& options)
      : file_(file), triangles_(file, options, "line") {}

  Scan read() {
    std::string_view line;
    while (file_.next_line(line)) read_line(line);
    if (in_facet_) {
      fail(fmt::format("the file ends inside a triangle, after {} complete ones", facets_));
    }
    if (facets_ == 0) fail("the STL file contains no triangles");
    if (in_solid_) {
      triangles_.builder().warn("The file ends without endsolid; it may be truncated.");
    }
    return triangles_.finish("STL ascii");
  }

 private:
  void read_line(std::string_view rest) {
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) read_word(word, rest);
    if (corner_numbers_ < 3) fail("\"\" is not a number");
  }

  void read_word(std::string_view word, std::string_view& rest) {
    const auto is = [&](std::string_view keyword) {
      return equal_ignoring_case(word, keyword) || (after_end_ && keyword.starts_with("end") &&
                                                    equal_ignoring_case(word, keyword.substr(3)));
    };
    if (corner_numbers_ < 3) return read_coordinate(word);
    if (is("endsolid")) {
      in_solid_ = false;
      rest = {};  // its name
    } else if (is("endfacet")) {
      end_facet();
    } else if (is("vertex")) {
      begin_corner();
    } else if (is("facet")) {
      begin_facet();
    } else if (is("normal")) {
      skip_numbers(rest);
    } else if (is("solid")) {
      in_solid_ = true;
      skip_name(rest);
    } else if (is("color")) {
      rest = {};
    } else if (!is("outer") && !is("loop") && !is("endloop") && !is("end")) {
      fail(fmt::format("\"{}\" is not a keyword of an STL file", printable(word)));
    }
    after_end_ = is("end");
  }

  /// The name of a solid may have any words; a facet may follow on the same line.
  static void skip_name(std::string_view& rest) {
    double value = 0;
    while (!rest.empty()) {
      std::string_view next = rest;
      if (equal_ignoring_case(take_word(next), "facet") &&
          equal_ignoring_case(take_word(next), "normal") && parse_number(take_word(next), value)) {
        return;
      }
      (void)take_word(rest);
    }
  }

  static void skip_numbers(std::string_view& rest) {
    double value = 0;
    for (std::string_view next = rest; parse_number(take_word(next), value);) rest = next;
  }

  void begin_facet() {
    if (in_facet_) fail("a triangle begins inside another");
    in_facet_ = true;
    corners_ = 0;
  }

  void begin_corner() {
    if (!in_facet_) fail("a vertex outside a triangle");
    if (corners_ == 3) fail("the triangle has more than three vertices");
    corner_numbers_ = 0;
  }

  void read_coordinate(std::string_view word) {
    double value = 0;
    if (!parse_number(word, value)) fail(fmt::format("\"{}\" is not a number", printable(word)));
    facet_[corners_][corner_numbers_] = static_cast<float>(value);
    if (++corner_numbers_ == 3) ++corners_;
  }

  void end_facet() {
    if (!in_facet_ || corners_ != 3) {
      fail(fmt::format("the triangle has {} vertices", in_facet_ ? corners_ : 0));
    }
    in_facet_ = false;
    ++facets_;
    triangles_.add(facet_, file_.line_number());
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyOrExportAgain);
  }

  InputFile& file_;
  Triangles triangles_;
  bool in_solid_ = false;
  bool in_facet_ = false;
  bool after_end_ = false;          // the previous word was "end"
  std::size_t corner_numbers_ = 3;  // numbers read of a vertex; 3: complete
  std::size_t corners_ = 0;
  std::uint64_t facets_ = 0;
  std::array<VertexWelder::Position, 3> facet_{};
};

void check_count(const InputFile& file, std::uint64_t declared) {
  const std::uint64_t there = (file.size() - kStlHeaderBytes) / kStlTriangleBytes;
  if (declared > there) {
    const bool lie = file.size() == kStlHeaderBytes + there * kStlTriangleBytes;
    throw ReadError(
        file.name(),
        fmt::format("byte {}", lie ? kStlCountByte : static_cast<std::size_t>(file.size())),
        fmt::format("the STL file declares {} triangles and holds {}{}", declared, there,
                    lie ? "" : ", the last one cut off"),
        "it was cut off, or its count is damaged; copy or export it again");
  }
  if (declared == 0) {
    throw ReadError(file.name(), fmt::format("byte {}", kStlCountByte),
                    "the STL file contains no triangles: its count is 0", kCopyOrExportAgain);
  }
}

/// Warns of bytes after the triangles that were read: more triangles, or other data.
void warn_of_rest(InputFile& file, std::uint64_t count, ScanBuilder& builder) {
  const std::uint64_t rest = file.remaining();
  if (rest == 0 || file.only_zeros_left()) return;
  const std::uint64_t more = rest / kStlTriangleBytes;
  if (more * kStlTriangleBytes == rest) {
    builder.warn_of_more("triangles", count, count + more);
  } else {
    builder.warn(
        fmt::format("{} bytes after the last of {} triangles were left out.", rest, count));
  }
}

bool are_plausible(std::string_view head, std::size_t at) {
  constexpr std::size_t kSamples = 16;
  if (head.substr(at, kStlTriangleBytes).find_first_not_of('\0') == head.npos) return false;
  for (std::size_t i = 0; i < kSamples && at + kStlTriangleBytes <= head.size(); ++i) {
    if (!is_plausible_triangle(head.data() + at)) return false;
    at += kStlTriangleBytes;
  }
  return true;
}

}  // namespace

bool is_exact_binary_stl(std::string_view head, std::uint64_t file_size) {
  if (head.size() < kStlHeaderBytes) return false;
  return file_size == kStlHeaderBytes + kStlTriangleBytes * std::uint64_t{count_in(head)};
}

std::optional<std::size_t> find_stl_triangles(std::string_view head, std::uint64_t file_size) {
  if (head.size() < kStlHeaderBytes + kStlTriangleBytes) return std::nullopt;
  const std::uint64_t counted = count_in(head) * std::uint64_t{kStlTriangleBytes};
  const bool has_count = count_in(head) > 0 && counted <= file_size - kStlHeaderBytes;
  const bool fits_without = (file_size - kStlCountByte) % kStlTriangleBytes == 0;
  if (!has_count && fits_without && are_plausible(head, kStlCountByte)) return kStlCountByte;
  if (are_plausible(head, kStlHeaderBytes)) return kStlHeaderBytes;
  return std::nullopt;
}

Scan read_stl_ascii(InputFile& file, const ReadOptions& options) {
  return AsciiReader(file, options).read();
}

Scan read_stl_binary(InputFile& file, const ReadOptions& options) {
  const std::string_view head = file.peek(kStlSampleBytes);
  if (head.size() < kStlHeaderBytes) {
    throw ReadError(
        file.name(), fmt::format("byte {}", head.size()),
        fmt::format("the file ends inside the header of {} bytes of a binary STL", kStlHeaderBytes),
        "it was cut off, or it is not an STL file; copy or export it again");
  }
  const std::uint64_t declared = count_in(head);
  const std::size_t begin = find_stl_triangles(head, file.size()).value_or(kStlHeaderBytes);
  const std::uint64_t room = (file.size() - begin) / kStlTriangleBytes;
  const bool by_size = begin == kStlCountByte || (declared == 0 && room > 0);
  if (!by_size) check_count(file, declared);
  Triangles triangles(file, options, "byte");
  if (begin == kStlCountByte) {
    triangles.builder().warn(fmt::format(
        "The STL file has no count after its first 80 bytes; by its size it holds {} triangles, "
        "which were read.",
        room));
  } else if (by_size) {
    triangles.builder().warn(fmt::format(
        "The STL file declares 0 triangles; by its size it holds {}, which were read.", room));
  }
  file.consume(begin);
  const std::uint64_t count = by_size ? room : declared;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t place = file.offset();
    const std::string_view bytes = file.peek(kStlTriangleBytes);
    if (bytes.size() < kStlTriangleBytes) check_count(file, count);
    std::array<VertexWelder::Position, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = load_vector(bytes.data() + kStlCornersByte + 12 * k);
    }
    file.consume(kStlTriangleBytes);
    triangles.add(corners, place);
  }
  warn_of_rest(file, count, triangles.builder());
  return triangles.finish("STL binary");
}

}  // namespace tactree::builder
