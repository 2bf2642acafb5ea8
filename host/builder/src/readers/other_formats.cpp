#include "other_formats.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "number.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_view_literals;

constexpr const char* kMeshToPly =
    "convert it with `meshio convert FILE scan.ply`, or open it in ParaView or Gmsh and save its "
    "surface as PLY or STL";
constexpr const char* kSurfaceToPly = "open it in CloudCompare or MeshLab and save it as PLY";
constexpr const char* kGridToXyz =
    "convert it to points with `gdal_translate -of XYZ FILE scan.xyz`";
constexpr const char* kCadToStl = "export it from the CAD program as STL or PLY";
constexpr const char* kPointsToPly = "convert it with `pdal translate FILE scan.ply`";
constexpr const char* kArrayToPly = "write its points as rows x y z, or as PLY";
constexpr const char* kVolumeToPly = "extract its surface, for example in ParaView or 3D Slicer";
constexpr const char* kNotAScan = "give the scan file";

struct Beginning {
  std::string_view bytes;
  const char* name;
  const char* remedy;
};

/// First bytes of the file.
constexpr Beginning kBeginnings[] = {
    {"# vtk DataFile"sv, "a VTK file (legacy .vtk)", kMeshToPly},
    {"$MeshFormat"sv, "a Gmsh mesh (.msh)", kMeshToPly},
    {"$NOD"sv, "a Gmsh mesh (.msh)", kMeshToPly},
    {"$ENTER"sv, "a PERMAS mesh", kMeshToPly},
    {"MeshVersionFormatted"sv, "a Medit mesh (.mesh)", kMeshToPly},
    {"\1\0\0\0\2\0\0\0\3\0\0\0"sv, "a Medit mesh (.meshb)", kMeshToPly},
    {"mesh3d"sv, "a Netgen mesh (.vol)", kMeshToPly},
    {"* FLAC3D"sv, "a FLAC3D grid", kMeshToPly},
    {"*GRIDPOINTS"sv, "a FLAC3D grid", kMeshToPly},
    {"Begin ModelPart"sv, "a Kratos mesh (.mdpa)", kMeshToPly},
    {"Begin Nodes"sv, "a Kratos mesh (.mdpa)", kMeshToPly},
    {"# AVS"sv, "an AVS file", kMeshToPly},
    {"# Created by COMSOL"sv, "a COMSOL mesh (.mphtxt)", kMeshToPly},
    {"/PREP7"sv, "an Ansys file (.cdb)", kMeshToPly},
    {"/COM"sv, "an Ansys file (.cdb)", kMeshToPly},
    {"FoamFile"sv, "an OpenFOAM file", kMeshToPly},
    {"#!ascii version of"sv, "a FreeSurfer surface", kMeshToPly},
    {"\xff\xff\xfe"sv, "a FreeSurfer surface", kMeshToPly},
    {"# AmiraMesh"sv, "an Amira mesh", kSurfaceToPly},
    {"# HyperSurface"sv, "an Amira surface", kSurfaceToPly},
    {"GOCAD "sv, "a GOCAD surface", kSurfaceToPly},
    {"#Inventor"sv, "an Open Inventor scene (.iv)", kSurfaceToPly},
    {"//Maya ASCII"sv, "a Maya scene", kSurfaceToPly},
    {"#usda"sv, "a USD scene", kSurfaceToPly},
    {"PXR-USDC"sv, "a USD scene", kSurfaceToPly},
    {"Ogawa"sv, "an Alembic scene", kSurfaceToPly},
    {"OCTM"sv, "an OpenCTM mesh", kSurfaceToPly},
    {"U3D\0"sv, "a U3D scene", kSurfaceToPly},
    {"CCB2"sv, "a CloudCompare file (.bin)", "open it in CloudCompare and save it as PLY"},
    {"[SBF]"sv, "the header of a CloudCompare cloud (.sbf)", kSurfaceToPly},
    {"# Bundle file"sv, "a Bundler reconstruction (.out)", kSurfaceToPly},
    {"NVM_V3"sv, "a VisualSFM reconstruction (.nvm)", kSurfaceToPly},
    {"\0\0\x27\x0a"sv, "a shapefile", kSurfaceToPly},
    {"BPF!"sv, "a BPF point cloud", kPointsToPly},
    {"DSAA"sv, "a Surfer grid (.grd)", kGridToXyz},
    {"DSBB"sv, "a Surfer grid (.grd)", kGridToXyz},
    {"DSRB"sv, "a Surfer grid (.grd)", kGridToXyz},
    {"FSASCI"sv, "a CPS-3 grid", kGridToXyz},
    {"binterr"sv, "a terrain file (.bt)", kGridToXyz},
    {"3D Geometry File Format"sv, "a Rhino file (.3dm)", kCadToStl},
    {"AutoCAD Binary DXF"sv, "a DXF drawing", kCadToStl},
    {"AC10"sv, "a DWG drawing", kCadToStl},
    {"\xff\xfe\xff\x0e"sv, "a SketchUp model (.skp)", kCadToStl},
    {"DBRep_DrawableShape"sv, "an OpenCASCADE shape (.brep)", kCadToStl},
    {"CASCADE Topology"sv, "an OpenCASCADE shape (.brep)", kCadToStl},
    {"\x89HDF\r\n\x1a\n"sv, "an HDF5 file (CGNS, MED, XDMF data, MATLAB 7.3, ...)", kMeshToPly},
    {"CDF\1"sv, "a NetCDF file (Exodus, a grid, ...)", kMeshToPly},
    {"CDF\2"sv, "a NetCDF file (Exodus, a grid, ...)", kMeshToPly},
    {"\x93NUMPY"sv, "a NumPy array (.npy)", kArrayToPly},
    {"MATLAB 5.0"sv, "a MATLAB file (.mat)", kArrayToPly},
    {"PAR1"sv, "a Parquet table", kArrayToPly},
    {"NRRD000"sv, "a volume (NRRD)", kVolumeToPly},
    {"ObjectType ="sv, "a volume (MetaImage)", kVolumeToPly},
    {" BDV"sv, "a volume (OpenVDB)", kVolumeToPly},
    {"$GP"sv, "a log of positions (NMEA)", kNotAScan},
    {"$GN"sv, "a log of positions (NMEA)", kNotAScan},
};

/// A keyword at the beginning of a line, in any case.
struct Keyword {
  std::string_view word;  // matches whole words if it ends with a letter
  const char* name;
  const char* remedy;
};

/// The keyword begins the first line.
constexpr Keyword kFirstLines[] = {
    {"ncols", "an ESRI grid (.asc)", kGridToXyz},
    {"nrows", "an ESRI grid (.asc)", kGridToXyz},
    {"north:", "a GRASS grid", kGridToXyz},
    {"title=", "a Tecplot file", kMeshToPly},
};

/// The keyword begins one of the first lines.
constexpr Keyword kAnyLines[] = {
    {"*node", "an Abaqus or LS-DYNA file", kMeshToPly},
    {"*keyword", "an LS-DYNA file", kMeshToPly},
    {"begin bulk", "a Nastran file", kMeshToPly},
    {"cend", "a Nastran file", kMeshToPly},
    {"grid*", "a Nastran file", kMeshToPly},
    {"grid,", "a Nastran file", kMeshToPly},
    {"$nodes", "a Gmsh mesh (.msh)", kMeshToPly},
    {"ndime=", "an SU2 mesh", kMeshToPly},
    {"type: ensight", "an EnSight case", kMeshToPly},
    {"node id ", "an EnSight geometry", kMeshToPly},
    {"nblock,", "an Ansys file (.cdb)", kMeshToPly},
    {"foamfile", "an OpenFOAM file", kMeshToPly},
    {"g0 x", "a machine program (G-code)", "give the model from which it was made"},
    {"g1 x", "a machine program (G-code)", "give the model from which it was made"},
    {"variables=", "a Tecplot file", kMeshToPly},
};

/// Elements of XML files.
constexpr Keyword kElements[] = {
    {"<VTKFile", "a VTK file (.vtu, .vtp, ...)", kMeshToPly},
    {"<Xdmf", "an XDMF file", kMeshToPly},
    {"<dolfin", "a DOLFIN mesh", kMeshToPly},
    {"<GIFTI", "a GIFTI surface", kMeshToPly},
    {"<LandXML", "a LandXML file", kSurfaceToPly},
    {"CityModel", "a CityGML model", kSurfaceToPly},
    {"<MeshLabProject", "a MeshLab project, which names scans but contains none",
     "give the files that it names"},
    {"<kml", "a KML file", kNotAScan},
    {"<gpx", "a GPX file", kNotAScan},
    {"<svg", "a drawing (SVG)", "give the scan, not a picture of it"},
};

constexpr std::size_t kKeywordLines = 400;
constexpr std::size_t kMaxLineChars = 512;

Recognition refused(const char* name, const char* remedy) {
  return {FileKind::kUnsupported, std::string(name) + ", which has no reader", remedy, ""};
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Ignores case, and white space before '='.
bool begins_with(std::string_view line, std::string_view keyword) {
  if (keyword.back() == '=') {
    const std::string_view word = keyword.substr(0, keyword.size() - 1);
    return starts_with_ignoring_case(line, word) && trim(line.substr(word.size())).starts_with('=');
  }
  if (!starts_with_ignoring_case(line, keyword)) return false;
  const std::string_view rest = line.substr(keyword.size());
  return !is_letter(keyword.back()) || rest.empty() || !(is_letter(rest.front()) || rest[0] == '_');
}

/// The lines including comments, without blank lines.
std::vector<std::string_view> raw_lines(std::string_view head, std::size_t count) {
  std::vector<std::string_view> lines;
  while (!head.empty() && lines.size() < count) {
    const std::size_t end = head.find_first_of("\r\n");
    const std::string_view line = trim(head.substr(0, end)).substr(0, kMaxLineChars);
    if (!line.empty()) lines.push_back(line);
    head.remove_prefix(end == std::string_view::npos ? head.size() : end + 1);
  }
  return lines;
}

/// Returns the numbers of a line, or none if it has anything else.
std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    double value = 0;
    if (!parse_number(word, value)) return {};
    numbers.push_back(value);
  }
  return numbers;
}

/// Returns the integers of a line, or none if it has anything else.
std::vector<std::int64_t> counts_of(std::string_view line) {
  std::vector<std::int64_t> counts;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    std::int64_t value = 0;
    if (!parse_integer(word, value)) return {};
    counts.push_back(value);
  }
  return counts;
}

/// Fixed columns, or numbers separated by white space, after the word GRID.
bool is_nastran_grid(std::string_view line) {
  return line.size() > 8 && starts_with_ignoring_case(line, "grid    ") &&
         line.find_first_of("0123456789") != std::string_view::npos;
}

/// Well-known text: TIN (((0 0 0, ..., MULTIPOINT Z ((1 2 3), ...
bool is_wkt(std::string_view line) {
  constexpr std::string_view kShapes[] = {"tin",          "multipoint", "polyhedralsurface",
                                          "multipolygon", "polygon",    "linestring"};
  const std::size_t open = line.find('(');
  if (open == std::string_view::npos) return false;
  std::string_view rest = line.substr(0, open);
  const std::string_view shape = take_word(rest);
  const bool dimensions = trim(rest).empty() || equal_ignoring_case(trim(rest), "z");
  return dimensions && std::any_of(std::begin(kShapes), std::end(kShapes),
                                   [&](auto known) { return equal_ignoring_case(shape, known); });
}

/// Protein Data Bank: lines of fixed columns.
bool is_pdb_atom(std::string_view line) {
  return line.size() >= 54 && (line.starts_with("ATOM  ") || line.starts_with("HETATM"));
}

bool is_universal(std::span<const std::string_view> lines) {
  constexpr std::string_view kDatasets[] = {"15", "151", "164", "2411", "2412", "2420", "781"};
  return lines.size() > 1 && lines[0] == "-1" &&
         std::find(std::begin(kDatasets), std::end(kDatasets), lines[1]) != std::end(kDatasets);
}

bool is_dxf(std::span<const std::string_view> lines) {
  return lines.size() > 1 && ((lines[0] == "0" && lines[1] == "SECTION") || lines[0] == "999");
}

/// IGES: lines of 80 characters with a letter in column 73 and a number after it.
bool is_iges(std::string_view head) {
  return head.size() > 80 && (head[72] == 'S' || head[72] == 'C') &&
         head.substr(0, 80).find('\n') == std::string_view::npos &&
         trim(head.substr(73, 7)).find_first_not_of("0123456789") == std::string_view::npos &&
         !trim(head.substr(73, 7)).empty();
}

/// A Fluent file, which consists of sections: (0 "comment"), (2 3), ...
bool is_fluent(std::string_view line) {
  return line.size() > 3 && line[0] == '(' && line[1] >= '0' && line[1] <= '9' &&
         (line[2] == ' ' || line[2] == '0');
}

/// A molecule: a count, a comment, and rows such as "C 0.0 0.0 0.0".
bool is_molecule(std::span<const std::string_view> lines) {
  if (lines.size() < 2 || counts_of(lines[0]).size() != 1) return false;
  // The comment may be blank; it is then not among the lines.
  for (const std::string_view line : lines.subspan(1, std::min<std::size_t>(lines.size() - 1, 2))) {
    std::string_view rest = line;
    const std::string_view element = take_word(rest);
    const bool symbol = element.size() <= 2 && !element.empty() && element[0] >= 'A' &&
                        element[0] <= 'Z' && (element.size() == 1 || is_letter(element[1]));
    if (symbol && numbers_of(rest).size() >= 3) return true;
  }
  return false;
}

/// True if the rows after the line of counts begin with the numbers 0, 1, 2, ... or 1, 2, 3, ...
/// and the last of the `count` rows has the expected number. If there are fewer lines, because the
/// file is longer than `lines` or was cut off, at least kManyRows must be present.
bool is_numbered(std::span<const std::string_view> lines, std::int64_t count) {
  constexpr std::uint64_t kRows = 100;
  constexpr std::uint64_t kManyRows = 8;
  if (count < 3) return false;
  const auto rows = static_cast<std::uint64_t>(count);
  const bool cut = rows > lines.size() - 1;
  const std::uint64_t whole = cut ? lines.size() - 2 : rows;  // the last line may be cut
  if (cut && whole < kManyRows) return false;
  double first = 0.0;
  const auto has_number = [&](std::uint64_t row) {
    const std::vector<double> numbers = numbers_of(lines[static_cast<std::size_t>(1 + row)]);
    if (row == 0 && !numbers.empty()) first = numbers.front();
    return numbers.size() >= 3 && first >= 0.0 && first <= 1.0 &&
           numbers.front() == first + static_cast<double>(row);
  };
  for (std::uint64_t row = 0; row < std::min(whole, kRows); ++row) {
    if (!has_number(row)) return false;
  }
  return has_number(whole - 1);
}

std::optional<Recognition> recognise_structure(std::string_view head,
                                               std::span<const std::string_view> lines) {
  if (is_universal(lines)) return refused("an I-DEAS universal file (.unv)", kMeshToPly);
  if (is_dxf(lines)) return refused("a DXF drawing", kCadToStl);
  if (is_iges(head)) return refused("an IGES file", kCadToStl);
  if (is_fluent(lines.front())) return refused("a Fluent mesh (.msh)", kMeshToPly);
  if (is_wkt(lines.front())) return refused("a WKT geometry", kSurfaceToPly);
  if (std::any_of(lines.begin(), lines.end(), is_pdb_atom)) {
    return refused("a molecule (PDB)", kNotAScan);
  }
  if (is_molecule(lines)) return refused("a molecule (XYZ of chemistry)", kNotAScan);
  return std::nullopt;
}

}  // namespace

std::optional<Recognition> recognise_other_format(std::string_view head) {
  for (const Beginning& known : kBeginnings) {
    if (head.starts_with(known.bytes)) return refused(known.name, known.remedy);
  }
  if (head.size() > 132 && head.substr(128, 4) == "DICM") {
    return refused("a volume (DICOM)", kVolumeToPly);
  }
  const std::vector<std::string_view> lines = raw_lines(head, kKeywordLines);
  if (lines.empty()) return std::nullopt;
  if (lines.front().starts_with('<')) {
    for (const Keyword& element : kElements) {
      if (head.find(element.word) != head.npos) return refused(element.name, element.remedy);
    }
    return std::nullopt;
  }
  for (const Keyword& known : kFirstLines) {
    if (begins_with(lines.front(), known.word)) return refused(known.name, known.remedy);
  }
  for (const std::string_view line : lines) {
    for (const Keyword& known : kAnyLines) {
      if (begins_with(line, known.word)) return refused(known.name, known.remedy);
    }
    if (is_nastran_grid(line)) return refused("a Nastran file", kMeshToPly);
  }
  return recognise_structure(head, lines);
}

std::optional<Recognition> recognise_counted_format(std::span<const std::string_view> lines) {
  if (lines.size() < 4) return std::nullopt;
  const std::vector<std::int64_t> counts = counts_of(lines[0]);
  if (counts.size() < 2 || *std::min_element(counts.begin(), counts.end()) < 0) return std::nullopt;
  if (counts.size() <= 5 && is_numbered(lines, counts[0])) {
    return counts.size() == 5
               ? refused("an AVS-UCD mesh", kMeshToPly)
               : refused("a TetGen or Triangle file (.node, .ele, .face)", kMeshToPly);
  }
  if (counts.size() == 7 && numbers_of(lines[1]).size() == 3) {
    return refused("a UGRID mesh", kMeshToPly);
  }
  const auto rows = static_cast<std::int64_t>(lines.size() - 1);
  if (counts.size() == 3 && counts[0] > 2 && counts[0] < rows && counts[1] < rows &&
      counts[2] < rows && counts[0] + counts[1] + counts[2] == rows) {
    return refused("a FreeFem mesh (.msh)", kMeshToPly);
  }
  return std::nullopt;
}

}  // namespace tactree::builder
