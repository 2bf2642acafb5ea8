#include "text_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "number.hpp"
#include "text_columns.hpp"
#include "text_fields.hpp"
#include "unit_names.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kMostNames = 4096;
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

std::string_view without_comment_signs(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of("/#%! \t"), text.size()));
  return trim(text);
}

char separator_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  if (has_tab_fields(line)) return '\t';
  return line.find(',') != std::string_view::npos ? ',' : ' ';
}

/// The fields of a line, without the empty ones at its end.
std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  std::string_view field;
  while (fields.size() < kMostNames && take_field(line, separator, field)) {
    fields.push_back(field);
  }
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  return fields;
}

bool is_in_brackets(std::string_view text) {
  return text.size() >= 2 && ((text.front() == '[' && text.back() == ']') ||
                              (text.front() == '(' && text.back() == ')'));
}

/// A name without its unit, and the unit: "x [m]", "x(m)" and "x_m".
struct WrittenName {
  std::string_view name;
  std::string_view unit;
};

WrittenName split_name(std::string_view field) {
  field = trim(without_comment_signs(field));
  const std::size_t bracket = field.find_first_of("[(");
  if (bracket != std::string_view::npos) {
    const std::string_view rest = field.substr(bracket + 1);
    return {trim(field.substr(0, bracket)), trim(rest.substr(0, rest.find_first_of("])")))};
  }
  const std::size_t line = field.rfind('_');
  if (line != std::string_view::npos && metres_of_unit(field.substr(line + 1))) {
    return {field.substr(0, line), field.substr(line + 1)};
  }
  return {field, ""};
}

std::vector<WrittenName> names_of(std::string_view line) {
  const char separator = separator_of(line);
  std::vector<std::string_view> fields = fields_of(line, separator);
  std::vector<WrittenName> names;
  for (std::string_view field : fields) {
    // In "x [m] y [m]", the unit is a word of its own.
    if (separator == ' ' && is_in_brackets(field) && !names.empty()) {
      names.back().unit = field.substr(1, field.size() - 2);
      continue;
    }
    names.push_back(split_name(field));
  }
  // "Format: x y z" and "Columns: x, y, z" begin with a label.
  if (!names.empty()) {
    const std::size_t colon = names[0].name.find(':');
    const bool is_slot = slot_of_name(names[0].name) != kNoSlot;  // points:0
    if (colon != std::string_view::npos && !is_slot) {
      names[0].name = trim(names[0].name.substr(colon + 1));
      if (names[0].name.empty()) names.erase(names.begin());
    }
  }
  return names;
}

/// The unit of x, y and z; 0 if they differ.
std::optional<double> common_unit(const std::array<std::optional<double>, 3>& units) {
  if (units[0] == units[1] && units[1] == units[2]) return units[0];
  return 0.0;
}

std::string name_given_twice(const std::vector<WrittenName>& names,
                             const std::vector<Slot>& slots) {
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const auto at = static_cast<std::size_t>(
        std::find(slots.begin(), slots.end(), static_cast<Slot>(axis)) - slots.begin());
    for (std::size_t i = at + 1; i < names.size(); ++i) {
      if (equal_ignoring_case(names[i].name, names[at].name)) {
        return fmt::format("columns {} and {} are both named {}", at + 1, i + 1,
                           printable(names[at].name));
      }
    }
  }
  return "";
}

}  // namespace

ColumnNames read_column_names(std::string_view line) {
  const std::vector<WrittenName> names = names_of(without_comment_signs(line));
  std::vector<std::string_view> bare;
  double value = 0;
  for (const WrittenName& name : names) {
    if (parse_number(name.name, value)) return {};
    bare.push_back(name.name);
  }
  ColumnNames found{slots_of_names(bare), names.size(), std::nullopt, ""};
  if (found.slots.empty()) return found;
  std::array<std::optional<double>, 3> units;
  for (std::size_t i = 0; i < found.slots.size(); ++i) {
    if (found.slots[i] <= kZ) units[found.slots[i]] = metres_of_unit(names[i].unit);
  }
  found.unit_m = common_unit(units);
  found.contradiction = name_given_twice(names, found.slots);
  return found;
}

std::optional<double> read_column_units(std::string_view line, char separator,
                                        const std::vector<Slot>& slots) {
  const std::vector<std::string_view> fields = fields_of(line, separator);
  std::array<std::optional<double>, 3> units;
  for (std::size_t i = 0; i < std::min(fields.size(), slots.size()); ++i) {
    if (slots[i] > kZ) continue;
    const bool bracketed = is_in_brackets(fields[i]);
    units[slots[i]] =
        metres_of_unit(bracketed ? fields[i].substr(1, fields[i].size() - 2) : fields[i]);
  }
  if (!units[0] || !units[1] || !units[2]) return std::nullopt;
  return common_unit(units);
}

std::string_view stated_unit(std::string_view line) {
  line = without_comment_signs(line);
  std::size_t end = 0;
  while (end < line.size() && line.substr(end, 1).find_first_of(":=,;\t ") != 0) ++end;
  const std::string_view key = line.substr(0, end);
  if (!equal_ignoring_case(key, "unit") && !equal_ignoring_case(key, "units")) return {};
  line = trim(line.substr(end));
  if (line.find_first_of(":=,;\t") != 0) return {};  // "unit vectors"
  line.remove_prefix(std::min(line.find_first_not_of(":=,;\t \""), line.size()));
  return trim(line.substr(0, line.find_first_of(",;\t\"")));
}

std::string remedy_of_names(std::string_view line) {
  bool degrees = false;
  bool angle = false;
  for (const WrittenName& name : names_of(without_comment_signs(line))) {
    const auto is = [&](std::string_view known) { return equal_ignoring_case(known, name.name); };
    degrees = degrees || is("lon") || is("long") || is("longitude") || is("lat") || is("latitude");
    angle = angle || is("azimuth") || is("az") || is("zenith") || is("theta") || is("phi");
  }
  if (degrees) {
    return "longitudes and latitudes are degrees: project them to metres first, for example in "
           "QGIS";
  }
  if (angle) return "convert ranges and angles to x, y and z first";
  return "rename these columns to x, y and z, or give their numbers, as in --columns x=2,y=3,z=4";
}

}  // namespace tactree::builder
