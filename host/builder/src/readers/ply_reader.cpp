#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ply_body.hpp"
#include "ply_header.hpp"
#include "readers.hpp"
#include "remedies.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {
namespace {

std::string rows_of(const PlyElement& element) {
  return element.name == "vertex" ? "vertices" : fmt::format("rows of \"{}\"", element.name);
}

const PlyElement& vertex_element(const InputFile& file, const PlyHeader& header) {
  const PlyElement* vertex = nullptr;
  for (const PlyElement& element : header.elements) {
    if (role_of(element) != PlyRole::kVertex) continue;
    if (vertex != nullptr) {
      throw ReadError(file.name(), "header", "there are two elements \"vertex\"", kExportAgain);
    }
    vertex = &element;
  }
  if (vertex == nullptr) {
    throw ReadError(file.name(), "header", "there is no element \"vertex\"", kExportAgain);
  }
  if (vertex->count == 0) {
    throw ReadError(file.name(), "header",
                    "the file contains no points: its header declares 0 vertices",
                    "check the export, and export it again");
  }
  return *vertex;
}

void check_coordinates(const InputFile& file, const std::vector<PlyField>& fields) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (const Slot slot : {kX, kY, kZ}) {
    const bool there = std::any_of(fields.begin(), fields.end(),
                                   [&](const PlyField& field) { return field.slot == slot; });
    if (there) continue;
    throw ReadError(file.name(), "header",
                    fmt::format("the vertices have no property \"{}\"", kNames[slot]),
                    kExportAgain);
  }
}

/// Refuses counts that exceed the size of a binary file, before memory is allocated for them.
void check_counts(const InputFile& file, std::span<const PlyElement> elements) {
  std::uint64_t room = file.remaining();
  bool at_most = false;
  for (const PlyElement& element : elements) {
    const std::uint64_t row_bytes = element.min_row_bytes();
    if (row_bytes == 0) continue;
    at_most = at_most || element.has_list();
    if (element.count > room / row_bytes) {
      throw_truncated(file, element, room / row_bytes, at_most);
    }
    room -= element.count * row_bytes;
  }
}

ColourRange colour_range(ScalarType type) {
  if (is_float(type)) return ColourRange::kAuto;
  return size_of(type) == 2 ? ColourRange::kWord : ColourRange::kByte;
}

void prepare(ScanBuilder& builder, const PlyElement& vertex, const std::vector<PlyField>& fields) {
  for (const PlyField& field : fields) {
    if (field.slot == kNx) builder.use_normals();
    if (field.slot == kRed)
      builder.use_colours(colour_range(vertex.properties[field.property].type));
  }
  builder.limit_face_indices(vertex.count);
}

/// The centres of Gaussian splats: points with a size, a turn and an opacity of their own.
bool are_splats(const PlyElement& vertex) {
  const auto has = [&](std::string_view name) {
    return std::any_of(vertex.properties.begin(), vertex.properties.end(),
                       [&](const PlyProperty& property) { return property.name == name; });
  };
  return has("scale_0") && has("rot_0") && has("opacity");
}

std::span<const PlyElement> elements_that_count(const PlyHeader& header) {
  std::size_t end = header.elements.size();
  while (end > 0 && role_of(header.elements[end - 1]) == PlyRole::kOther) --end;
  return std::span(header.elements).first(end);
}

bool has_faces(std::span<const PlyElement> elements) {
  return std::any_of(elements.begin(), elements.end(), [](const PlyElement& element) {
    return role_of(element) != PlyRole::kVertex && role_of(element) != PlyRole::kOther &&
           element.count > 0;
  });
}

/// `more` is the number of rows after those of `elements`.
void warn_of_more(const PlyHeader& header, std::span<const PlyElement> elements, std::uint64_t more,
                  ScanBuilder& builder) {
  for (std::size_t i = elements.size(); i < header.elements.size(); ++i) {
    const PlyElement& unused = header.elements[i];
    if (!unused.properties.empty()) more -= std::min(more, unused.count);
  }
  if (more == 0) return;
  const PlyElement& last = elements.back();
  builder.warn_of_more(rows_of(last), last.count, last.count + more);
}

/// Some programs use another name for the list of vertices. It is accepted if it is the only list
/// of integers.
std::size_t only_list(const PlyElement& element) {
  const auto is_candidate = [](const PlyProperty& property) {
    return property.is_list && !is_float(property.type);
  };
  const auto& properties = element.properties;
  const auto found = std::find_if(properties.begin(), properties.end(), is_candidate);
  const bool only = std::count_if(properties.begin(), properties.end(), is_candidate) == 1;
  return only ? static_cast<std::size_t>(found - properties.begin()) : properties.size();
}

}  // namespace

PlyRole role_of(const PlyElement& element) {
  if (element.name == "vertex") return PlyRole::kVertex;
  if (index_property(element) == element.properties.size()) return PlyRole::kOther;
  if (element.name == "face") return PlyRole::kFace;
  return element.name == "tristrips" ? PlyRole::kStrip : PlyRole::kOther;
}

std::size_t index_property(const PlyElement& element) {
  const auto found = std::find_if(
      element.properties.begin(), element.properties.end(), [](const PlyProperty& property) {
        return property.is_list &&
               (property.name == "vertex_indices" || property.name == "vertex_index");
      });
  if (found == element.properties.end() && element.name == "face") return only_list(element);
  return static_cast<std::size_t>(found - element.properties.begin());
}

std::vector<PlyField> vertex_fields(const PlyElement& vertex) {
  std::vector<PlyField> fields;
  std::array<bool, kSlots> filled{};
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    const Slot slot = property.is_list ? kNoSlot : slot_of_name(property.name);
    if (slot == kNoSlot || filled[slot]) continue;
    filled[slot] = true;
    fields.push_back({i, slot});
  }
  const bool normals = filled[kNx] && filled[kNy] && filled[kNz];
  const bool colours = filled[kRed] && filled[kGreen] && filled[kBlue];
  std::erase_if(fields, [&](const PlyField& field) {
    if (field.slot >= kRed) return !colours;
    return field.slot >= kNx && !normals;
  });
  return fields;
}

void throw_truncated(const InputFile& file, const PlyElement& element, std::uint64_t rows_there,
                     bool at_most) {
  const std::string rows = rows_of(element);
  throw ReadError(
      file.name(), fmt::format("byte {}", file.size()),
      fmt::format("the file ends too early: its header declares {} {}, only {}{} are present",
                  element.count, rows, at_most ? "at most " : "", rows_there),
      "it was cut off, or its header is damaged; copy or export it again");
}

void StripReader::add(std::int64_t index) {
  if (index == -1) {
    length_ = 0;
    return;
  }
  if (++length_ >= 3) {
    const bool swapped = length_ % 2 == 0;
    const std::array<std::int64_t, 3> corners = {swapped ? newer_ : older_,
                                                 swapped ? older_ : newer_, index};
    // Strips repeat an index to change direction; such a triangle is not an error.
    const bool turns = older_ == newer_ || newer_ == index || older_ == index;
    if (!turns) builder_.add_face(corners, place_);
  }
  older_ = newer_;
  newer_ = index;
}

Scan read_ply(InputFile& file, const ReadOptions& options) {
  const PlyHeader header = read_ply_header(file);
  const PlyElement& vertex = vertex_element(file, header);
  const std::vector<PlyField> fields = vertex_fields(vertex);
  check_coordinates(file, fields);
  const std::span<const PlyElement> elements = elements_that_count(header);
  const bool ascii = header.encoding == PlyEncoding::kAscii;
  if (!ascii) check_counts(file, elements);
  ScanBuilder builder(file.name(), options, ascii ? "line" : "byte");
  prepare(builder, vertex, fields);
  if (!has_faces(elements)) builder.thin_large_cloud();
  if (header.unknown_lines > 0) {
    builder.warn(fmt::format("{}: {} line{} of the header {} unknown and left out, the first at {}",
                             file.name(), header.unknown_lines,
                             header.unknown_lines == 1 ? "" : "s",
                             header.unknown_lines == 1 ? "is" : "are", header.unknown_line));
  }
  if (are_splats(vertex)) {
    builder.warn(fmt::format(
        "{}: the points are the centres of Gaussian splats, which lie about the surface, not on it "
        "(build from the mesh or the point cloud of the same pictures instead)",
        file.name()));
  }
  if (ascii) {
    // A value takes at least two bytes; missing rows are detected while reading.
    const std::uint64_t room = (file.remaining() + 1) / (2 * vertex.properties.size());
    builder.expect_points(std::min(vertex.count, room));
  } else {
    builder.reserve_points(vertex.count);
  }
  if (ascii) {
    warn_of_more(header, elements, read_ply_ascii(file, elements, builder), builder);
    return builder.finish("PLY ascii");
  }
  const bool big = header.encoding == PlyEncoding::kBigEndian;
  const double row_bytes = read_ply_binary(file, elements, big, builder);
  const double more = static_cast<double>(file.remaining()) / row_bytes;
  // If unused elements follow, their lists may have any length, so the number of rows is unknown.
  const bool last = elements.size() == header.elements.size();
  if (last && more >= 1.0 && !file.only_zeros_left()) {
    warn_of_more(header, elements, static_cast<std::uint64_t>(more), builder);
  }
  return builder.finish(big ? "PLY binary big endian" : "PLY binary little endian");
}

}  // namespace tactree::builder
