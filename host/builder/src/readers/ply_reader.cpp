#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "number.hpp"
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

template <std::size_t N>
bool is_name_in(std::string_view name, const std::array<std::string_view, N>& names) {
  return std::any_of(names.begin(), names.end(),
                     [name](std::string_view known) { return equal_ignoring_case(name, known); });
}

bool are_faces(const PlyElement& element) {
  constexpr std::array<std::string_view, 10> kFaces = {
      "face",      "faces",   "facet",    "facets", "triangle",
      "triangles", "polygon", "polygons", "quad",   "quads"};
  return is_name_in(element.name, kFaces);
}

/// True if elements of this name have corners: faces in a form without a reader, or solids.
bool may_be_faces(const PlyElement& element) {
  constexpr std::array<std::string_view, 7> kBegins = {"face", "tri", "poly", "quad",
                                                       "tet",  "hex", "cell"};
  return std::any_of(kBegins.begin(), kBegins.end(), [&](std::string_view begin) {
    return starts_with_ignoring_case(element.name, begin);
  });
}

bool is_list_of_integers(const PlyProperty& property) {
  return property.is_list && !is_float(property.type);
}

/// The only list that meets the condition, or properties.size().
template <typename Condition>
std::size_t only_list(const PlyElement& element, Condition condition) {
  const auto& properties = element.properties;
  const auto found = std::find_if(properties.begin(), properties.end(), condition);
  const bool only = std::count_if(properties.begin(), properties.end(), condition) == 1;
  return only ? static_cast<std::size_t>(found - properties.begin()) : properties.size();
}

bool has_standard_name(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// The names that some programs use instead.
bool has_other_name(const PlyProperty& property) {
  constexpr std::array<std::string_view, 8> kNames = {
      "vertex_indices", "vertex_index", "vertex_idx", "vertex_idxs",
      "vertex_ids",     "vertex_id",    "vertices",   "verts"};
  return is_list_of_integers(property) && is_name_in(property.name, kNames);
}

void warn_of_unknown_faces(const InputFile& file, const PlyHeader& header, bool mesh,
                           ScanBuilder& builder) {
  for (const PlyElement& element : header.elements) {
    if (element.count == 0 || role_of(element) != PlyRole::kOther || !may_be_faces(element)) {
      continue;
    }
    builder.warn(fmt::format(
        "{}: header: the {} rows of \"{}\" are not faces in a known form and were left out{} "
        "(export the mesh again, with a list \"vertex_indices\" in the element \"face\")",
        file.name(), element.count, printable(element.name),
        mesh ? "" : "; the vertices were taken as a cloud of points"));
  }
}

/// Refuses names of which it is not known which one is meant.
void check_names(const InputFile& file, const PlyElement& vertex) {
  const auto& properties = vertex.properties;
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].is_list || slot_of_name(properties[i].name) == kNoSlot) continue;
    for (std::size_t k = 0; k < i; ++k) {
      if (properties[k].is_list || !equal_ignoring_case(properties[k].name, properties[i].name)) {
        continue;
      }
      throw ReadError(file.name(), "header",
                      fmt::format("the vertices have two properties \"{}\" and \"{}\"",
                                  properties[k].name, properties[i].name),
                      "export the scan again, with one property of each name");
    }
  }
}

}  // namespace

PlyRole role_of(const PlyElement& element) {
  if (element.name == "vertex") return PlyRole::kVertex;
  if (index_property(element) == element.properties.size()) return PlyRole::kOther;
  if (are_faces(element)) return PlyRole::kFace;
  return element.name == "tristrips" ? PlyRole::kStrip : PlyRole::kOther;
}

std::size_t index_property(const PlyElement& element) {
  const auto& properties = element.properties;
  const auto standard = std::find_if(properties.begin(), properties.end(), has_standard_name);
  if (standard != properties.end() || !are_faces(element)) {
    return static_cast<std::size_t>(standard - properties.begin());
  }
  const std::size_t named = only_list(element, has_other_name);
  return named < properties.size() ? named : only_list(element, is_list_of_integers);
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
  check_names(file, vertex);
  const std::span<const PlyElement> elements = elements_that_count(header);
  const bool ascii = header.encoding == PlyEncoding::kAscii;
  if (!ascii) check_counts(file, elements);
  ScanBuilder builder(file.name(), options, ascii ? "line" : "byte");
  prepare(builder, vertex, fields);
  const bool mesh = has_faces(elements);
  if (!mesh) builder.thin_large_cloud();
  warn_of_unknown_faces(file, header, mesh, builder);
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
