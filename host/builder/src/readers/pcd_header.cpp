#include "pcd_header.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "number.hpp"
#include "remedies.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kMaxHeaderBytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kMaxPointBytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kNotGiven = std::numeric_limits<std::uint64_t>::max();

std::optional<ScalarType> scalar_type(char kind, std::uint64_t size) {
  const bool floating = kind == 'F';
  const bool is_signed = kind == 'I';
  if (!floating && !is_signed && kind != 'U') return std::nullopt;
  switch (size) {
    case 1:
      if (floating) return std::nullopt;
      return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
    case 2:
      if (floating) return std::nullopt;
      return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
    case 4:
      if (floating) return ScalarType::kFloat32;
      return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
    case 8:
      if (floating) return ScalarType::kFloat64;
      return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
    default:
      return std::nullopt;
  }
}

class PcdHeaderParser {
 public:
  explicit PcdHeaderParser(InputFile& file) : file_(file) {}

  PcdHeader parse() {
    std::string_view line;
    while (file_.offset() <= kMaxHeaderBytes && file_.next_line(line)) {
      const std::string_view keyword = take_word(line);
      if (keyword.empty() || keyword.front() == '#') continue;
      if (keyword == "DATA") return finish(take_word(line));
      parse_line(keyword, line);
    }
    throw ReadError(file_.name(), "header", "the file ends before the line DATA",
                    "the file was cut off; copy or export it again");
  }

 private:
  void parse_line(std::string_view keyword, std::string_view rest) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      names_.clear();
      for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
        names_.emplace_back(word);
      }
    } else if (keyword == "SIZE") {
      sizes_ = integers(rest);
    } else if (keyword == "COUNT") {
      counts_ = integers(rest);
    } else if (keyword == "TYPE") {
      types_.clear();
      for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
        types_.push_back(word.front());
      }
    } else if (keyword == "WIDTH") {
      width_ = integer(take_word(rest));
    } else if (keyword == "HEIGHT") {
      height_ = integer(take_word(rest));
    } else if (keyword == "POINTS") {
      points_ = integer(take_word(rest));
    } else if (keyword == "VIEWPOINT") {
      read_viewpoint(rest);
    } else if (keyword != "VERSION") {
      fail(fmt::format("\"{}\" is not a keyword of a PCD header", printable(keyword)));
    }
  }

  // Position and quaternion. Only the position is used, because the orientation of the points
  // depends on it alone.
  void read_viewpoint(std::string_view rest) {
    Eigen::Matrix<double, 7, 1> values;
    bool good = true;
    for (double& value : values) {
      good = good && parse_number(take_word(rest), value) && std::isfinite(value);
    }
    viewpoint_.reset();
    if (good) {
      viewpoint_ = values.head<3>();
    } else {
      warnings_.emplace_back("VIEWPOINT is not seven numbers; it was ignored.");
    }
  }

  std::vector<std::uint64_t> integers(std::string_view rest) const {
    std::vector<std::uint64_t> values;
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
      values.push_back(integer(word));
    }
    return values;
  }

  std::uint64_t integer(std::string_view word) const {
    std::int64_t value = 0;
    if (!parse_integer(word, value) || value < 0) {
      fail(fmt::format("\"{}\" is not a count", printable(word)));
    }
    return static_cast<std::uint64_t>(value);
  }

  PcdHeader finish(std::string_view data) {
    PcdHeader header;
    if (data == "ascii") {
      header.data = PcdData::kAscii;
    } else if (data == "binary") {
      header.data = PcdData::kBinary;
    } else if (data == "binary_compressed") {
      header.data = PcdData::kBinaryCompressed;
    } else {
      fail(fmt::format("the kind of data \"{}\" is not known", printable(data)));
    }
    add_fields(header);
    set_points(header);
    header.viewpoint = viewpoint_;
    header.warnings.insert(header.warnings.end(), warnings_.begin(), warnings_.end());
    return header;
  }

  void add_fields(PcdHeader& header) const {
    if (names_.empty()) fail("the line FIELDS is missing");
    if (sizes_.size() != names_.size() || types_.size() != names_.size() ||
        (!counts_.empty() && counts_.size() != names_.size())) {
      fail(fmt::format("FIELDS names {} fields, SIZE {}, TYPE {} and COUNT {}: they must agree",
                       names_.size(), sizes_.size(), types_.size(), counts_.size()));
    }
    std::uint64_t offset = 0;
    std::uint64_t column = 0;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::optional<ScalarType> type = scalar_type(types_[i], sizes_[i]);
      if (!type) {
        fail(fmt::format("a field of type {} and size {} is not known", types_[i], sizes_[i]));
      }
      PcdField field{names_[i], *type, counts_.empty() ? 1 : counts_[i], offset, column};
      if (field.count > kMaxPointBytes) fail("a point has more than 1 MiB of data");
      offset += field.bytes();
      column += field.count;
      if (offset > kMaxPointBytes) fail("a point has more than 1 MiB of data");
      header.fields.push_back(std::move(field));
    }
  }

  void set_points(PcdHeader& header) const {
    const bool grid = width_ != kNotGiven;
    const std::uint64_t height = height_ == kNotGiven ? 1 : height_;
    std::uint64_t in_grid = 0;
    if (grid && __builtin_mul_overflow(width_, height, &in_grid)) {
      fail("WIDTH times HEIGHT is too large a number");
    }
    if (!grid && points_ == kNotGiven) fail("neither POINTS nor WIDTH says how many points follow");
    header.points = points_ == kNotGiven ? in_grid : points_;
    if (grid && header.points != in_grid) {
      header.warnings.push_back(fmt::format(
          "The header declares {} points, but WIDTH times HEIGHT is {}; the former was used.",
          header.points, in_grid));
    } else if (grid && height > 1) {
      header.width = width_;
    }
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), "header, " + file_.line_place(), cause, kExportAgain);
  }

  InputFile& file_;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> sizes_;
  std::vector<char> types_;
  std::vector<std::uint64_t> counts_;
  std::optional<Eigen::Vector3d> viewpoint_;
  std::vector<std::string> warnings_;
  std::uint64_t width_ = kNotGiven;
  std::uint64_t height_ = kNotGiven;
  std::uint64_t points_ = kNotGiven;
};

}  // namespace

std::uint64_t PcdHeader::point_bytes() const {
  std::uint64_t bytes = 0;
  for (const PcdField& field : fields) bytes += field.bytes();
  return bytes;
}

std::uint64_t PcdHeader::columns() const {
  std::uint64_t columns = 0;
  for (const PcdField& field : fields) columns += field.count;
  return columns;
}

PcdHeader read_pcd_header(InputFile& file) { return PcdHeaderParser(file).parse(); }

}  // namespace tactree::builder
