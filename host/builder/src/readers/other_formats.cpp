#include "other_formats.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "number.hpp"
#include "remedies.hpp"
#include "signatures.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kLines = 20000;  // of the beginning of a file; many may be comments
constexpr std::size_t kMaxLineChars = 512;

Recognition refused(const char* name, const char* remedy) {
  return {FileKind::kUnsupported, std::string(name) + ", which has no reader", remedy, ""};
}

Recognition refused(const Signature& signature) {
  return refused(signature.name, signature.remedy);
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

/// Fixed columns, or fields separated by commas, after a keyword of nodes or elements.
bool is_nastran_card(std::string_view line) {
  constexpr std::string_view kCards[] = {"grid",   "ctria3", "ctria6", "cquad4", "cquad8",
                                         "ctetra", "chexa",  "cpenta", "cbar",   "cbeam"};
  const bool known = std::any_of(std::begin(kCards), std::end(kCards), [&](auto card) {
    return starts_with_ignoring_case(line, card) && line.size() > card.size() &&
           (line[card.size()] == ' ' || line[card.size()] == ',' || line[card.size()] == '*');
  });
  // The first field has eight characters, filled with spaces, or ends with a comma.
  const bool field = line.find(',') < 8 || (line.size() > 8 && line[7] == ' ');
  return known && field && std::any_of(line.begin(), line.end(), is_digit);
}

/// N,1,0.5,0.25,0 and then N,2,...: the nodes of an Ansys script.
bool are_ansys_nodes(std::span<const std::string_view> lines) {
  const auto number = [](std::string_view line) {
    std::int64_t value = -1;
    if (!starts_with_ignoring_case(line, "n,")) return value;
    line.remove_prefix(2);
    (void)parse_integer(trim(line.substr(0, line.find(','))), value);
    return value;
  };
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const std::int64_t first = number(lines[i]);
    if (first > 0 && number(lines[i + 1]) == first + 1) return true;
  }
  return false;
}

/// ZONE T="a", N=100, ...
bool is_tecplot_zone(std::string_view line) {
  return equal_ignoring_case(take_word(line), "zone") && line.find('=') != std::string_view::npos;
}

/// type: ensight gold
bool is_ensight_case(std::string_view line) {
  return starts_with_ignoring_case(line, "type:") &&
         starts_with_ignoring_case(trim(line.substr(5)), "ensight");
}

/// G1 X10 Y2, also after the number of a block: N20 G1 X10.
bool is_gcode(std::string_view line) {
  std::string_view word = take_word(line);
  if (word.size() > 1 && word[0] == 'N' && is_digit(word[1])) word = take_word(line);
  const std::string_view axis = take_word(line);
  return word.size() == 2 && (word[0] == 'G' || word[0] == 'g') && word[1] >= '0' &&
         word[1] <= '1' && axis.size() > 1 && (axis[0] == 'X' || axis[0] == 'x');
}

/// $GPGGA,123519,...
bool is_nmea(std::string_view line) {
  return line.size() > 6 && line.starts_with("$G") && line[6] == ',' &&
         std::all_of(line.begin() + 1, line.begin() + 6, is_letter);
}

/// A GXF grid: this keyword alone, then heights.
bool is_gxf(std::string_view line) { return equal_ignoring_case(line, "#grid"); }

/// Point(1) = {0, 0, 0};
bool is_gmsh_script(std::string_view line) {
  return starts_with_ignoring_case(line, "point(") && line.find("= {") != std::string_view::npos;
}

/// Well-known text: TIN (((0 0 0, ..., MULTIPOINT Z ((1 2 3), ...
bool is_wkt(std::string_view line) {
  if (starts_with_ignoring_case(line, "srid=")) {
    line.remove_prefix(std::min(line.find(';') + 1, line.size()));
  }
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

/// A dataset of an I-DEAS file: -1, then its number.
bool is_universal(std::span<const std::string_view> lines) {
  return lines.size() > 1 && lines[0] == "-1" && lines[1].size() <= 4 &&
         std::all_of(lines[1].begin(), lines[1].end(), is_digit);
}

/// CalculiX: the records 1C and 1U.
bool is_calculix(std::span<const std::string_view> lines) {
  return lines.size() > 1 && lines[0].starts_with("1C") && lines[1].starts_with("1U");
}

/// The points of an OpenFOAM mesh without its header: a count, and rows in parentheses.
bool is_foam_list(std::span<const std::string_view> lines) {
  return lines.size() > 2 && counts_of(lines[0]).size() == 1 && lines[1] == "(" &&
         lines[2].starts_with('(');
}

/// A picture or a grid of floats: P2 or Pf, and the width and the height.
bool is_netpbm(std::span<const std::string_view> lines) {
  const bool magic = lines[0].size() == 2 && (lines[0][0] == 'P' || lines[0][0] == 'p') &&
                     (is_digit(lines[0][1]) || lines[0] == "Pf" || lines[0] == "PF");
  std::size_t next = 1;
  while (next < lines.size() && lines[next].starts_with('#')) ++next;
  return magic && next < lines.size() && counts_of(lines[next]).size() == 2;
}

/// Rows "G 1 0.5 0.25 0" of grid points.
bool is_flac(std::span<const std::string_view> lines) {
  constexpr std::size_t kRows = 4;
  if (lines.size() < kRows) return false;
  return std::all_of(lines.begin(), lines.begin() + kRows, [](std::string_view line) {
    return take_word(line) == "G" && numbers_of(line).size() == 4;
  });
}

/// An Irap grid: -996, the number of rows, two steps, then 19 numbers.
bool is_irap(std::span<const std::string_view> lines) {
  const std::vector<double> first = numbers_of(lines[0]);
  return first.size() == 4 && first[0] == -996.0 && lines.size() > 1 &&
         numbers_of(lines[1]).size() == 4;
}

/// The counts of a GTS surface may be followed by the names of its classes.
bool is_gts(std::string_view line) {
  return line.find("GtsSurface") != std::string_view::npos ||
         line.find("GtsVertex") != std::string_view::npos;
}

/// Comments with the code 999 may come first.
bool is_dxf(std::span<const std::string_view> lines) {
  std::size_t at = 0;
  while (at + 3 < lines.size() && lines[at] == "999") at += 2;
  return at + 1 < lines.size() && lines[at] == "0" && lines[at + 1] == "SECTION";
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

struct LineTest {
  bool (*matches)(std::string_view line);
  const char* name;
  const char* remedy;
};

constexpr LineTest kAnyLine[] = {
    {is_nastran_card, "a Nastran file", kMeshToPly},
    {is_ensight_case, "an EnSight case", kMeshToPly},
    {is_tecplot_zone, "a Tecplot file", kMeshToPly},
    {is_gcode, "a machine program (G-code)", "give the model from which it was made"},
    {is_pdb_atom, "a molecule (PDB)", kNotAScan},
    {is_gxf, "a GXF grid", kGridToXyz},
    {is_nmea, "a log of positions (NMEA)", kNotAScan},
};

constexpr LineTest kFirstLine[] = {
    {is_fluent, "a Fluent mesh (.msh)", kMeshToPly},
    {is_wkt, "a WKT geometry", kSurfaceToPly},
    {is_gts, "a GTS surface", kSurfaceToPly},
    {is_gmsh_script, "a Gmsh script (.geo)", kMeshToPly},
};

struct FileTest {
  bool (*matches)(std::span<const std::string_view> lines);
  const char* name;
  const char* remedy;
};

constexpr FileTest kFiles[] = {
    {is_universal, "an I-DEAS universal file (.unv)", kMeshToPly},
    {is_calculix, "a CalculiX result (.frd)", kMeshToPly},
    {is_dxf, "a DXF drawing", kCadToStl},
    {is_foam_list, "an OpenFOAM file", kMeshToPly},
    {is_netpbm, "a picture", "give the scan, not a picture of it"},
    {is_flac, "a FLAC3D grid", kMeshToPly},
    {is_irap, "an Irap grid", kGridToXyz},
    {are_ansys_nodes, "an Ansys file", kMeshToPly},
    {is_molecule, "a molecule (XYZ of chemistry)", kNotAScan},
};

std::optional<Recognition> recognise_structure(std::string_view head,
                                               std::span<const std::string_view> lines) {
  for (const FileTest& test : kFiles) {
    if (test.matches(lines)) return refused(test.name, test.remedy);
  }
  for (const LineTest& test : kFirstLine) {
    if (test.matches(lines.front())) return refused(test.name, test.remedy);
  }
  if (is_iges(head)) return refused("an IGES file", kCadToStl);
  return std::nullopt;
}

/// True for a comment in any of the formats.
bool is_comment(std::string_view line) {
  constexpr std::string_view kBegin = "#%!$*/;|";
  return kBegin.find(line.front()) != std::string_view::npos || line.starts_with("--");
}

}  // namespace

std::optional<Recognition> recognise_by_signature(std::string_view head, bool text) {
  for (const Signature& known : binary_signatures()) {
    const bool there = head.size() >= known.at + known.bytes.size() &&
                       head.substr(known.at, known.bytes.size()) == known.bytes;
    if (!text && there) return refused(known);
  }
  for (const std::string_view line : raw_lines(head, kLines)) {
    for (const Signature& known : first_line_signatures()) {
      if (begins_with(line, known.bytes)) return refused(known);
    }
    if (!is_comment(line)) break;
  }
  const std::size_t begin = head.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || head[begin] != '<') return std::nullopt;
  for (const Signature& known : xml_signatures()) {
    if (head.find(known.bytes) != head.npos) return refused(known);
  }
  return std::nullopt;
}

std::optional<Recognition> recognise_by_lines(std::string_view head) {
  const std::vector<std::string_view> lines = raw_lines(head, kLines);
  if (lines.empty()) return std::nullopt;
  for (const std::string_view line : lines) {
    for (const Signature& known : line_signatures()) {
      if (begins_with(line, known.bytes)) return refused(known);
    }
    for (const LineTest& test : kAnyLine) {
      if (test.matches(line)) return refused(test.name, test.remedy);
    }
  }
  return recognise_structure(head, lines);
}

std::optional<Recognition> recognise_counted_format(std::span<const std::string_view> lines) {
  if (lines.size() < 4) return std::nullopt;
  const std::vector<std::int64_t> counts = counts_of(lines[0]);
  if (counts.size() == 9 && counts[0] == 25) return refused("a Patran file", kMeshToPly);
  if (counts.size() < 2 || *std::min_element(counts.begin(), counts.end()) < 0) return std::nullopt;
  if (counts.size() <= 5 && is_numbered(lines, counts[0])) {
    return counts.size() == 5
               ? refused("an AVS-UCD mesh", kMeshToPly)
               : refused("a TetGen or Triangle file (.node, .ele, .face)", kMeshToPly);
  }
  if (counts.size() == 4 && counts[0] == 0 && counts[1] == 3) {
    return refused("a TetGen file (.poly, .smesh)", kMeshToPly);
  }
  if (counts.size() == 7 && numbers_of(lines[1]).size() == 3) {
    return refused("a UGRID mesh", kMeshToPly);
  }
  const auto rows = static_cast<std::int64_t>(lines.size() - 1);
  const bool fits = counts.size() == 3 && counts[0] > 2 && counts[0] < rows && counts[1] < rows &&
                    counts[2] < rows && counts[0] + counts[1] + counts[2] == rows;
  if (!fits) return std::nullopt;
  // Rows such as "3 0 1 2" after the points are the faces of an OFF file.
  const std::vector<std::int64_t> last = counts_of(lines.back());
  const bool faces = !last.empty() && last.front() + 1 == static_cast<std::int64_t>(last.size());
  if (!faces) return refused("a FreeFem mesh (.msh)", kMeshToPly);
  return Recognition{FileKind::kUnsupported, "an OFF file without the line OFF at its beginning",
                     "read it with --format off", ""};
}

}  // namespace tactree::builder
