// STL (stereolithography), text and binary. Every triangle repeats its corners; bitwise equal ones
// become one point. assimp is not used here: it trusts the count in the file.

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

constexpr const char* kExportAgain = "copy or export it again";

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

/// Adds triangles to a builder, merging equal corners.
class Triangles {
 public:
  Triangles(const InputFile& file, const ReadOptions& options, const char* place_unit)
      : builder_(file.name(), options.scan_memory_bytes, place_unit) {}

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
    if (facets_ == 0) fail("the STL file holds no triangle");
    if (in_solid_) {
      triangles_.builder().warn("The file ends without endsolid; it may be truncated.");
    }
    return triangles_.finish("STL ascii");
  }

 private:
  void read_line(std::string_view rest) {
    const std::string_view keyword = take_word(rest);
    const auto is = [&](std::string_view word) { return equal_ignoring_case(keyword, word); };
    if (is("vertex")) {
      read_corner(rest);
    } else if (is("facet")) {
      if (in_facet_) fail("a triangle begins inside another");
      in_facet_ = true;
      corners_ = 0;
    } else if (is("endfacet")) {
      end_facet();
    } else if (is("solid")) {
      in_solid_ = true;
    } else if (is("endsolid")) {
      in_solid_ = false;
    } else if (!keyword.empty() && !is("outer") && !is("endloop") && !is("color")) {
      fail(fmt::format("\"{}\" is not a word of an STL file", printable(keyword)));
    }
  }

  void read_corner(std::string_view rest) {
    if (!in_facet_) fail("a vertex outside a triangle");
    if (corners_ == 3) fail("the triangle has more than three corners");
    for (float& coordinate : facet_[corners_]) {
      double value = 0;
      const std::string_view word = take_word(rest);
      if (!parse_number(word, value)) {
        fail(fmt::format("\"{}\" is not a number", printable(word)));
      }
      coordinate = static_cast<float>(value);
    }
    ++corners_;
  }

  void end_facet() {
    if (!in_facet_ || corners_ != 3) {
      fail(fmt::format("the triangle has {} corners", in_facet_ ? corners_ : 0));
    }
    in_facet_ = false;
    ++facets_;
    triangles_.add(facet_, file_.line_number());
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kExportAgain);
  }

  InputFile& file_;
  Triangles triangles_;
  bool in_solid_ = false;
  bool in_facet_ = false;
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
                    "the STL file holds no triangle: its count is 0", kExportAgain);
  }
}

}  // namespace

bool is_exact_binary_stl(std::string_view head, std::uint64_t file_size) {
  if (head.size() < kStlHeaderBytes) return false;
  return file_size == kStlHeaderBytes + kStlTriangleBytes * std::uint64_t{count_in(head)};
}

bool looks_like_binary_stl(std::string_view head, std::uint64_t file_size) {
  if (file_size < kStlHeaderBytes + kStlTriangleBytes) return false;
  constexpr std::size_t kSamples = 16;
  std::size_t at = kStlHeaderBytes;
  const std::string_view first = head.substr(at, kStlTriangleBytes);
  if (first.find_first_not_of('\0') == std::string_view::npos) return false;
  for (std::size_t i = 0; i < kSamples && at + kStlTriangleBytes <= head.size(); ++i) {
    if (!is_plausible_triangle(head.data() + at)) return false;
    at += kStlTriangleBytes;
  }
  return true;
}

Scan read_stl_ascii(InputFile& file, const ReadOptions& options) {
  return AsciiReader(file, options).read();
}

Scan read_stl_binary(InputFile& file, const ReadOptions& options) {
  const std::uint64_t count = count_in(file.peek(kStlHeaderBytes));
  check_count(file, count);
  file.consume(kStlHeaderBytes);
  Triangles triangles(file, options, "byte");
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
  if (file.remaining() > 0) {
    triangles.builder().warn(
        fmt::format("{} bytes after the last triangle were ignored.", file.remaining()));
  }
  return triangles.finish("STL binary");
}

}  // namespace tactree::builder
