#include "mesh_import/mesh_extractor.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <span>

#include "src/readers/number.hpp"
#include "src/readers/unit_names.hpp"

namespace tactree::builder {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::size_t kMaxMarkup = std::size_t{1} << 24;  // longer markup is read as a whole

/// Resources of the materials extension, which may be as large as the mesh.
constexpr std::string_view kUnusedResources[] = {"colorgroup", "texture2dgroup",
                                                 "compositematerials", "multiproperties"};

std::string_view without_space(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  return text;
}

bool is_name_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == ':' || byte >= 0x80;
}

std::string_view take_name(std::string_view& text) {
  const auto* const end = std::find_if_not(text.begin(), text.end(), is_name_character);
  const auto length = static_cast<std::size_t>(end - text.begin());
  const std::string_view name = text.substr(0, length);
  text.remove_prefix(length);
  return name;
}

std::string_view local(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// Length of the markup at the beginning of `text`, or npos if its end is not there yet.
std::size_t markup_length(std::string_view text) {
  const auto until = [&](std::size_t from, std::string_view end) {
    const std::size_t at = text.find(end, from);
    return at == std::string_view::npos ? at : at + end.size();
  };
  constexpr std::string_view kComment = "<!--";
  constexpr std::string_view kData = "<![CDATA[";
  if (text.starts_with("<?")) return until(2, "?>");
  if (text.starts_with(kComment)) return until(kComment.size(), "-->");
  if (text.starts_with(kData)) return until(kData.size(), "]]>");
  if (kComment.starts_with(text) || kData.starts_with(text)) return std::string_view::npos;
  std::size_t at = 1;
  while (true) {
    at = text.find_first_of(">\"'", at);
    if (at == std::string_view::npos || text[at] == '>') break;
    at = text.find(text[at], at + 1);
    if (at == std::string_view::npos) break;
    ++at;
  }
  return at == std::string_view::npos ? at : at + 1;
}

/// Finds the values of attributes by their local names; the first of each name counts. Returns
/// false if the text is malformed, or has references to characters.
bool find_attributes(std::string_view text, std::span<const std::string_view> names,
                     std::span<std::string_view> values) {
  for (text = without_space(text); !text.empty(); text = without_space(text)) {
    const std::string_view name = local(take_name(text));
    text = without_space(text);
    if (name.empty() || !text.starts_with('=')) return false;
    text = without_space(text.substr(1));
    if (text.empty() || (text[0] != '"' && text[0] != '\'')) return false;
    const std::size_t end = text.find(text[0], 1);
    if (end == std::string_view::npos) return false;
    const std::string_view value = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
    if (value.find_first_of("&<") != std::string_view::npos) return false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == name && values[i].data() == nullptr) values[i] = value;
    }
  }
  return true;
}

}  // namespace

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  return parse_number(trim(text), value) ? std::optional(value) : std::nullopt;
}

double metres_of_print_unit(std::string_view name) {
  const std::optional<double> metres = metres_of_unit(name.empty() ? "millimeter" : name);
  if (!metres) {
    throw ImportError("its unit \"" + std::string(name.substr(0, 20)) + "\" is not known");
  }
  return *metres;
}

std::uint32_t index_of(std::string_view text) {
  text = trim(text);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole ? value : std::numeric_limits<std::uint32_t>::max();
}

ImportError not_a(std::string_view text, const std::string& what) {
  const bool comma = text.find(',') != std::string_view::npos;
  return ImportError("\"" + std::string(text.substr(0, 20)) + "\" is not a " + what +
                     (comma ? ", which needs a decimal point" : ""));
}

bool MeshExtractor::feed(std::string_view bytes) {
  open_ += bytes;
  std::string_view text = open_;
  if (!begun_ && text.size() >= 2) {
    begun_ = true;
    const auto is_wide = [](char c) { return c == '\0' || c == '\xff' || c == '\xfe'; };
    if (is_wide(text[0]) || is_wide(text[1])) return false;
  }
  while (!text.empty()) {
    const std::size_t begin = std::min(text.find('<'), text.size());
    if (!take_text(text.substr(0, begin))) return false;
    text.remove_prefix(begin);
    const std::size_t length = text.empty() ? std::string_view::npos : markup_length(text);
    if (length == std::string_view::npos) break;
    if (!take_markup(text.substr(0, length))) return false;
    text.remove_prefix(length);
  }
  open_.erase(0, open_.size() - text.size());
  return open_.size() <= kMaxMarkup;
}

bool MeshExtractor::is_complete() const { return open_.empty() && inside_ == Inside::kDocument; }

bool MeshExtractor::take_text(std::string_view text) {
  if (inside_ == Inside::kDocument) {
    rest_ += text;
    return true;
  }
  return inside_ == Inside::kUnused || text.find_first_not_of(kSpace) == std::string_view::npos;
}

bool MeshExtractor::take_markup(std::string_view markup) {
  if (markup.starts_with("<?") || markup.starts_with("<!--")) {
    if (inside_ == Inside::kDocument) rest_ += markup;
    return true;
  }
  if (markup.starts_with("<!")) {
    if (inside_ != Inside::kDocument || !markup.starts_with("<![CDATA[")) return false;
    rest_ += markup;
    return true;
  }
  return take_tag(markup);
}

bool MeshExtractor::take_tag(std::string_view tag) {
  std::string_view inner = tag.substr(1, tag.size() - 2);
  const bool closes = inner.starts_with('/');
  const bool empty = !closes && inner.ends_with('/');
  if (closes) inner.remove_prefix(1);
  if (empty) inner.remove_suffix(1);
  const std::string_view name = local(take_name(inner));
  if (name.empty() || inner.find('<') != std::string_view::npos) return false;
  if (inside_ == Inside::kDocument) {
    rest_ += tag;
    if (!closes && !empty) begin_block(name);
    return true;
  }
  if (closes && element_open_) {
    element_open_ = false;
    return name == element_name();
  }
  if (closes && name == block_name_) {
    inside_ = Inside::kDocument;
    rest_ += tag;
    return true;
  }
  if (inside_ == Inside::kUnused) return true;
  return !closes && !element_open_ && take_element(name, inner, empty);
}

/// Begins a block if the start tag of one was read.
void MeshExtractor::begin_block(std::string_view name) {
  const bool unused = std::find(std::begin(kUnusedResources), std::end(kUnusedResources), name) !=
                      std::end(kUnusedResources);
  const bool mesh = name == "vertices" || name == "triangles";
  if (!unused && !mesh) return;
  block_name_ = name;
  if (unused) {
    inside_ = Inside::kUnused;
    return;
  }
  inside_ = name == "vertices" ? Inside::kVertices : Inside::kTriangles;
  rest_ += std::to_string(blocks_.size());
  blocks_.emplace_back();
}

std::string_view MeshExtractor::element_name() const {
  return inside_ == Inside::kVertices ? "vertex" : "triangle";
}

bool MeshExtractor::take_element(std::string_view name, std::string_view attributes, bool empty) {
  if (!error_.empty()) return true;
  if (name != element_name()) return empty;  // of another extension
  element_open_ = !empty;
  try {
    return inside_ == Inside::kVertices ? add_vertex(attributes) : add_triangle(attributes);
  } catch (const ImportError& error) {
    // The checksum of the archive has not been checked yet, so that this may be a consequence.
    error_ = error.what();
    return true;
  }
}

bool MeshExtractor::add_vertex(std::string_view attributes) {
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  std::array<std::string_view, 3> values;
  if (!find_attributes(attributes, kAxes, values)) return false;
  std::vector<Eigen::Vector3d>& vertices = blocks_.back().vertices;
  Eigen::Vector3d vertex;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::string_view text = values[static_cast<std::size_t>(axis)];
    const std::optional<double> number = number_of(text);
    if (!number) throw not_a(text, "coordinate of vertex " + std::to_string(vertices.size()));
    vertex[axis] = *number;
  }
  vertices.push_back(vertex);
  return true;
}

bool MeshExtractor::add_triangle(std::string_view attributes) {
  constexpr std::array<std::string_view, 3> kCorners = {"v1", "v2", "v3"};
  std::array<std::string_view, 3> values;
  if (!find_attributes(attributes, kCorners, values)) return false;
  blocks_.back().triangles.push_back(
      {index_of(values[0]), index_of(values[1]), index_of(values[2])});
  return true;
}

}  // namespace tactree::builder
