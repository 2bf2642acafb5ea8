#include "recognise.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "number.hpp"
#include "other_formats.hpp"
#include "scalar.hpp"
#include "stl_layout.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_view_literals;

constexpr const char* kUnpackRemedy = "unpack it and give the scan inside";
constexpr const char* kMeshRemedy = "open it in Blender or MeshLab and save it as PLY";

struct ImportMagic {
  std::size_t at;
  std::string_view bytes;
  const char* name;
  const char* hint;
};

constexpr ImportMagic kImportMagics[] = {
    {0, "glTF"sv, "glTF binary (GLB)", "glb"},
    {0, "Kaydara FBX Binary"sv, "FBX binary", "fbx"},
    {0, "; FBX"sv, "FBX text", "fbx"},
    {0, "BLENDER"sv, "Blender file", "blend"},
    {8, "LWOB"sv, "LightWave object", "lwo"},
    {8, "LWO2"sv, "LightWave object", "lwo"},
    {0, "MS3D000000"sv, "MilkShape 3D", "ms3d"},
    {0, "xof 03"sv, "DirectX X", "x"},
    {0, "AC3D"sv, "AC3D", "ac"},
    {0, "#VRML"sv, "VRML", "wrl"},
    {0, "#X3D"sv, "X3D", "x3d"},
    {0, "IDP2"sv, "Quake II model", "md2"},
    {0, "IDP3"sv, "Quake III model", "md3"},
    {0, "*3DSMAX_ASCIIEXPORT"sv, "3ds Max ASE", "ase"},
    {0, "OgreXML"sv, "Ogre mesh", "mesh"},
};

bool has_magic(std::string_view head, std::size_t at, std::string_view bytes) {
  return head.size() >= at + bytes.size() && head.substr(at, bytes.size()) == bytes;
}

Recognition unsupported(const std::string& name, const std::string& remedy) {
  return {FileKind::kUnsupported, name, remedy, ""};
}

Recognition imported(const std::string& name, const std::string& hint) {
  return {FileKind::kImportedMesh, name, "", hint};
}

/// Returns the first lines, at most `count`, without blank lines and lines that begin with '#'.
std::vector<std::string_view> first_lines(std::string_view head, std::size_t count) {
  std::vector<std::string_view> lines;
  while (!head.empty() && lines.size() < count) {
    const std::size_t end = head.find_first_of("\r\n");
    const std::string_view line = trim(head.substr(0, end));
    if (!line.empty() && line.front() != '#') lines.push_back(line);
    head.remove_prefix(end == std::string_view::npos ? head.size() : end + 1);
  }
  return lines;
}

std::string_view first_word(std::string_view line) { return take_word(line); }

bool begins_with_number(std::string_view text) {
  double value = 0;
  return parse_number(take_word(text), value);
}

/// LAZ sets the upper bits of the point format and adds a separate record. It has no reader,
/// because its library, liblaszip, is not part of Debian 12.
Recognition recognise_las(std::string_view head) {
  constexpr std::size_t kPointFormatByte = 104;
  const bool compressed = (head.size() > kPointFormatByte &&
                           (static_cast<unsigned char>(head[kPointFormatByte]) & 0xc0) != 0) ||
                          head.find("laszip encoded") != std::string_view::npos;
  if (!compressed) return {FileKind::kLas, "LAS", "", ""};
  return unsupported(
      "a LAZ file (compressed LAS), which has no reader",
      "unpack it with `laszip -i FILE -o scan.las` or `pdal translate FILE scan.las`, "
      "or open it in CloudCompare and save it as PLY");
}

std::optional<Recognition> recognise_zip(std::string_view head) {
  if (!head.starts_with("PK\x03\x04") && !head.starts_with("PK\x05\x06")) return std::nullopt;
  const auto contains = [&](std::string_view word) { return head.find(word) != head.npos; };
  // An Open Packaging file: a 3MF, or an office document. Pictures may precede the model.
  const bool package = contains("[Content_Types].xml") || contains("_rels/") || contains("3D/") ||
                       contains("Metadata/");
  const bool office = contains("word/") || contains("xl/") || contains("ppt/");
  if (package && !office) return imported("3MF", "3mf");
  if (contains(".amf") || contains(".AMF")) return imported("AMF", "amf");
  if (contains(".usdc") || contains(".usda")) {
    return unsupported("a USD scene (.usdz), which has no reader",
                       "open it in Blender and save it as glTF or PLY");
  }
  if (contains(".npy")) {
    return unsupported("a NumPy archive (.npz), which has no reader",
                       "write its points as rows x y z, or as PLY");
  }
  if (contains(".brp")) {
    return unsupported("a FreeCAD document, which has no reader", "export it as STL or PLY");
  }
  return unsupported("a zip archive", kUnpackRemedy);
}

std::optional<Recognition> recognise_3ds(std::string_view head, std::uint64_t file_size) {
  if (!head.starts_with("MM") || head.size() < 16) return std::nullopt;
  const std::uint32_t length = load_bits<std::uint32_t, false>(head.data() + 2);
  const std::uint16_t next = load_bits<std::uint16_t, false>(head.data() + 6);
  const bool known_chunk = next == 0x0002 || next == 0x3d3d || next == 0xb000;
  if (!known_chunk || length < 16 || length / 2 > file_size) return std::nullopt;
  return imported("3DS", "3ds");
}

std::optional<Recognition> recognise_markup(std::string_view head) {
  const std::string_view text =
      trim(head.substr(std::min(head.find_first_not_of("\n\r \t"), head.size())));
  const auto contains = [&](std::string_view word) { return head.find(word) != head.npos; };
  if (text.starts_with('{') && contains("\"geometricError\"")) {
    return unsupported("the index of 3D Tiles, which has no reader",
                       "export the model as glTF or PLY from the program that made the tiles");
  }
  if (text.starts_with('{') && contains("\"CityJSON\"")) {
    return unsupported("a CityJSON model, which has no reader",
                       "convert it to glTF, for example in Blender");
  }
  if (text.starts_with('{') && contains("\"asset\"")) return imported("glTF", "gltf");
  if (text.starts_with('{') && contains("\"buffers\"")) return imported("glTF", "gltf");
  if (text.starts_with('{') || text.starts_with('[')) {
    return unsupported("a JSON file", "give the scan file, or write its points as rows x y z");
  }
  if (starts_with_ignoring_case(text, "<!doctype html") ||
      starts_with_ignoring_case(text, "<html")) {
    return unsupported("an HTML page, perhaps the error page of a download",
                       "download the scan again and check the result");
  }
  if (!text.starts_with("<?xml") && !text.starts_with('<')) return std::nullopt;
  if (contains("<COLLADA")) return imported("COLLADA", "dae");
  if (contains("<X3D")) return imported("X3D", "x3d");
  if (contains("<amf")) return imported("AMF", "amf");
  if (contains("<html")) return unsupported("an HTML page", "give the scan file");
  if (contains("<mesh>")) return imported("Ogre mesh XML", "mesh.xml");
  return unsupported("an XML file", kMeshRemedy);
}

bool is_off_keyword(std::string_view word) {
  constexpr std::string_view kKeywords[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",  "NCOFF",
                                            "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  return std::find(std::begin(kKeywords), std::end(kKeywords), word) != std::end(kKeywords);
}

/// "OFF", or "OFF490 518 0", as in the collection ModelNet.
bool begins_off(std::string_view word) {
  if (is_off_keyword(word)) return true;
  return word.size() > 3 && word.starts_with("OFF") &&
         word.find_first_not_of("0123456789", 3) == std::string_view::npos;
}

bool is_binary_off(std::string_view head) {
  std::string_view first = head.substr(0, head.find('\n'));
  return is_off_keyword(take_word(first)) && take_word(first) == "BINARY";
}

bool is_obj(const std::vector<std::string_view>& lines) {
  constexpr std::string_view kKeywords[] = {"v", "vn", "vt", "vp",     "f",      "l",     "p",
                                            "o", "g",  "s",  "mtllib", "usemtl", "usemap"};
  if (std::find(std::begin(kKeywords), std::end(kKeywords), first_word(lines.front())) ==
      std::end(kKeywords)) {
    return false;
  }
  const auto is_keyword = [&](std::string_view line) {
    return std::find(std::begin(kKeywords), std::end(kKeywords), first_word(line)) !=
           std::end(kKeywords);
  };
  // The normals of a large mesh may come before its points.
  constexpr std::size_t kManyLines = 1000;
  const bool vertices = std::any_of(lines.begin(), lines.end(), [](std::string_view line) {
    return take_word(line) == "v" && begins_with_number(line);
  });
  return vertices || (lines.size() > kManyLines &&
                      std::all_of(lines.begin(), lines.begin() + kManyLines, is_keyword));
}

/// The keywords of an STL may share a line.
bool is_stl(const std::vector<std::string_view>& lines) {
  std::string_view first = lines.front();
  for (auto word = take_word(first); !word.empty(); word = take_word(first)) {
    if (equal_ignoring_case(word, "facet") && equal_ignoring_case(take_word(first), "normal")) {
      return true;
    }
  }
  const std::string_view second = lines.size() > 1 ? first_word(lines[1]) : ""sv;
  return starts_with_ignoring_case(second, "facet") || starts_with_ignoring_case(second, "end") ||
         starts_with_ignoring_case(second, "color");
}

/// Leica PTX: columns, rows, then a position and three axes, then a 4 x 4 matrix.
bool is_ptx(const std::vector<std::string_view>& lines) {
  constexpr std::array<int, 10> kNumbers = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
  if (lines.size() < kNumbers.size()) return false;
  for (std::size_t i = 0; i < kNumbers.size(); ++i) {
    std::string_view rest = lines[i];
    double value = 0;
    int count = 0;
    while (parse_number(take_word(rest), value)) ++count;
    if (count != kNumbers[i] || !trim(rest).empty()) return false;
  }
  return true;
}

bool is_pcd(std::string_view head, const std::vector<std::string_view>& lines) {
  if (head.starts_with("# .PCD")) return true;
  const std::string_view word = lines.empty() ? ""sv : first_word(lines.front());
  const auto names_fields = [](std::string_view first) {
    return first == "FIELDS" || first == "COLUMNS";  // before version 0.7
  };
  if (word != "VERSION" && !names_fields(word)) return false;
  return std::any_of(lines.begin(), lines.end(),
                     [&](std::string_view line) { return names_fields(first_word(line)); });
}

Recognition recognise_text(std::string_view head) {
  constexpr std::size_t kManyLines = 20000;  // comments or normals may come first
  const std::vector<std::string_view> lines = first_lines(head, kManyLines);
  if (lines.empty()) return {FileKind::kText, "text", "", ""};
  const std::string_view word = first_word(lines.front());
  if (begins_off(word)) return {FileKind::kOff, "OFF", "", ""};
  if (word == "4OFF" || word == "nOFF" || word == "4nOFF") {
    return unsupported("an OFF file whose points are not three-dimensional", kMeshRemedy);
  }
  if (equal_ignoring_case(word, "solid") && is_stl(lines)) {
    return {FileKind::kStlAscii, "STL ascii", "", ""};
  }
  if (is_obj(lines)) return {FileKind::kObj, "OBJ", "", ""};
  if (is_ptx(lines)) return {FileKind::kPtx, "PTX", "", ""};
  if (auto other = recognise_by_lines(head)) return *other;
  if (auto counted = recognise_counted_format(lines)) return *counted;
  return {FileKind::kText, "text", "", ""};
}

std::optional<Recognition> recognise_imported(std::string_view head) {
  for (const ImportMagic& magic : kImportMagics) {
    if (has_magic(head, magic.at, magic.bytes)) return imported(magic.name, magic.hint);
  }
  return std::nullopt;
}

/// By the words of its header. Only "ply" in small letters at the very beginning is sure, because a
/// table may have such a title.
bool is_ply(std::string_view head) {
  const bool sure = head.starts_with("ply");
  std::string_view first = sure ? head.substr(0, head.find('\n')) : ""sv;
  if (take_word(first) == "ply" && trim(first.substr(0, first.find('\r'))).empty()) return true;
  const std::vector<std::string_view> lines = first_lines(head.substr(0, 4096), 2);
  if (lines.size() < 2 || !equal_ignoring_case(lines[0], "ply")) return false;
  const std::string_view word = first_word(lines[1]);
  return equal_ignoring_case(word, "format") || equal_ignoring_case(word, "comment") ||
         equal_ignoring_case(word, "obj_info");
}

}  // namespace

bool is_text(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0x7f || (byte < 0x20 && !is_space(c) && c != '\n' && c != 0x1a);
  });
}

Recognition recognise(std::string_view head, std::uint64_t file_size) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  if (is_ply(head)) return {FileKind::kPly, "PLY", "", ""};
  if (head.starts_with("# .PCD")) return {FileKind::kPcd, "PCD", "", ""};
  if (is_exact_binary_stl(head, file_size)) return {FileKind::kStlBinary, "STL binary", "", ""};
  if (head.starts_with("ASTM-E57")) return {FileKind::kE57, "E57", "", ""};
  if (head.starts_with("LASF")) return recognise_las(head);
  if (auto zip = recognise_zip(head)) return *zip;
  if (auto mesh = recognise_3ds(head, file_size)) return *mesh;
  const bool text = is_text(head);
  if (auto other = recognise_by_signature(head, text)) return *other;
  if (auto scene = recognise_imported(head)) return *scene;
  if (is_pcd(head, first_lines(head.substr(0, 4096), 32))) return {FileKind::kPcd, "PCD", "", ""};
  if (is_binary_off(head)) return {FileKind::kOffBinary, "OFF binary", "", ""};
  if (text) {
    if (auto markup = recognise_markup(head)) return *markup;
    return recognise_text(head);
  }
  if (find_stl_triangles(head, file_size)) {
    return {FileKind::kStlBinary, "STL binary", "", ""};
  }
  // Damaged text is passed to its reader, which reports the damage with a line number.
  const Recognition as_text = recognise_text(head);
  if (as_text.kind != FileKind::kText) return as_text;
  return unsupported("not a scan in a supported format",
                     "name its format with --format, or save the scan as PLY, PCD, PTX, E57, LAS, "
                     "XYZ, OBJ, STL, OFF, glTF or 3MF");
}

}  // namespace tactree::builder
