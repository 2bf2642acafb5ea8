#include "ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "number.hpp"
#include "remedies.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kMaxPlyHeaderBytes = std::uint64_t{1} << 20;

std::optional<ScalarType> scalar_type(std::string_view name) {
  struct Alias {
    std::string_view name;
    ScalarType type;
  };
  constexpr Alias kAliases[] = {
      {"char", ScalarType::kInt8},      {"int8", ScalarType::kInt8},
      {"uchar", ScalarType::kUint8},    {"uint8", ScalarType::kUint8},
      {"short", ScalarType::kInt16},    {"int16", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},  {"uint16", ScalarType::kUint16},
      {"int", ScalarType::kInt32},      {"int32", ScalarType::kInt32},
      {"uint", ScalarType::kUint32},    {"uint32", ScalarType::kUint32},
      {"float", ScalarType::kFloat32},  {"float32", ScalarType::kFloat32},
      {"double", ScalarType::kFloat64}, {"float64", ScalarType::kFloat64},
      {"int64", ScalarType::kInt64},    {"uint64", ScalarType::kUint64},
  };
  for (const Alias& alias : kAliases) {
    if (alias.name == name) return alias.type;
  }
  return std::nullopt;
}

class PlyHeaderParser {
 public:
  explicit PlyHeaderParser(InputFile& file) : file_(file) {}

  PlyHeader parse() {
    std::string_view line;
    while (next_line(line)) {
      const std::string_view keyword = take_word(line);
      if (keyword == "end_header") return finish();
      parse_line(keyword, line);
    }
    throw ReadError(file_.name(), "header", "the file ends before end_header",
                    "the file was cut off, or its header is damaged; copy or export it again");
  }

 private:
  bool next_line(std::string_view& line) {
    if (file_.offset() > kMaxPlyHeaderBytes) fail("the header is longer than 1 MiB");
    return file_.next_line(line);
  }

  void parse_line(std::string_view keyword, std::string_view rest) {
    if (equal_ignoring_case(keyword, "ply") || keyword == "comment" || keyword == "obj_info" ||
        keyword.empty())
      return;
    if (keyword == "format") return parse_format(take_word(rest));
    if (keyword == "element") return parse_element(rest);
    if (keyword == "property") return parse_property(rest);
    const std::string_view first = keyword.substr(0, 40);
    const bool binary =
        std::any_of(first.begin(), first.end(), [](char c) { return c < ' ' || c > '~'; });
    if (binary) fail("the data begins without the line end_header before it");
    if (describes_data(rest)) {
      fail(fmt::format("\"{}\" is not a keyword of a PLY header", printable(keyword)));
    }
    if (header_.unknown_lines++ == 0) {
      header_.unknown_line = fmt::format("{}, \"{}\"", file_.line_place(), printable(keyword));
    }
  }

  /// True for a damaged line "element" or "property". It must not be ignored, because the data
  /// would be misread.
  static bool describes_data(std::string_view words) {
    while (true) {
      const std::string_view word = take_word(words);
      if (word.empty()) return false;
      if (scalar_type(word) || word == "list" || word == "vertex" || word == "face" ||
          word == "ascii" || word.starts_with("binary_")) {
        return true;
      }
    }
  }

  void parse_format(std::string_view name) {
    has_format_ = true;
    if (name == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      fail(fmt::format("the format \"{}\" is not known", printable(name)));
    }
  }

  void parse_element(std::string_view rest) {
    PlyElement element;
    element.name = take_word(rest);
    const std::string_view count_word = take_word(rest);
    std::int64_t count = 0;
    if (!parse_integer(count_word, count)) {
      fail(fmt::format("the number of \"{}\" is \"{}\", which is not a count",
                       printable(element.name), printable(count_word)));
    }
    if (count < 0) {
      fail(fmt::format("the number of \"{}\" is negative: {}", printable(element.name), count));
    }
    element.count = static_cast<std::uint64_t>(count);
    header_.elements.push_back(std::move(element));
  }

  void parse_property(std::string_view rest) {
    if (header_.elements.empty()) fail("a property comes before the first element");
    PlyProperty property;
    std::string_view type = take_word(rest);
    if (type == "list") {
      property.is_list = true;
      property.count_type = type_of(take_word(rest));
      if (is_float(property.count_type)) fail("the length of a list is not an integer type");
      type = take_word(rest);
    }
    property.type = type_of(type);
    property.name = take_word(rest);
    if (property.name.empty()) fail("a property has no name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  ScalarType type_of(std::string_view name) {
    const std::optional<ScalarType> type = scalar_type(name);
    if (!type) fail(fmt::format("the property type \"{}\" is not known", printable(name)));
    return *type;
  }

  PlyHeader finish() {
    if (!has_format_) {
      throw ReadError(file_.name(), "header", "the format line is missing", kExportAgain);
    }
    return std::move(header_);
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), "header, " + file_.line_place(), cause, kExportAgain);
  }

  InputFile& file_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

std::uint64_t PlyElement::min_row_bytes() const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += size_of(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& property) { return property.is_list; });
}

PlyHeader read_ply_header(InputFile& file) { return PlyHeaderParser(file).parse(); }

}  // namespace tactree::builder
