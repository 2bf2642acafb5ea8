#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "no_data.hpp"
#include "number.hpp"
#include "readers.hpp"
#include "scan_builder.hpp"
#include "text_columns.hpp"
#include "text_layout.hpp"
#include "text_names.hpp"

namespace tactree::builder {
namespace {

class TextReader {
 public:
  TextReader(InputFile& file, const ReadOptions& options)
      : file_(file),
        layout_(find_text_layout(file, options.columns)),
        columns_named_(!options.columns.empty()),
        declared_(layout_.declared.value_or(0)),
        builder_(file.name(), options, "line") {}

  Scan read() {
    for (const std::string& warning : layout_.warnings) builder_.warn(warning);
    note_columns();
    if (layout_.unit_m) builder_.set_unit(*layout_.unit_m);
    if (layout_.has(kNx)) builder_.use_normals();
    if (layout_.has(kRed)) builder_.use_colours(ColourRange::kAuto);
    builder_.thin_large_cloud();
    builder_.expect_points(
        1024 +
        static_cast<std::uint64_t>(1.05 * static_cast<double>(file_.size()) / layout_.row_bytes));
    std::string_view line;
    while (file_.next_line(line)) read_line(line);
    check_bad_rows();
    check_counter();
    check_faces();
    drop_no_data();
    if (layout_.declared && declared_ != builder_.points_read()) {
      builder_.warn(fmt::format("The file declares {} points and holds {}.", declared_,
                                builder_.points_read()));
    }
    return builder_.finish(format_name());
  }

 private:
  void read_line(std::string_view line) {
    const std::uint64_t number = file_.line_number();
    if (number == layout_.header_line || number == layout_.unit_line) return;
    // Skips the names in a header that the user has replaced.
    if (columns_named_ && file_.line_number() < layout_.first_row_line) return;
    const std::string_view text = text_of_line(line);
    if (text.empty()) return;
    PointRow row{};
    if (parse(text, row)) {
      count_integers(row);
      heights_.add(row[kZ]);
      builder_.add_point(row);
      return;
    }
    if (layout_.declared && is_count(text)) return;
    if (repeats_names(text)) return;
    if (file_.line_number() < layout_.first_row_line) {
      if (head_lines_++ == 0) first_head_line_ = file_.line_number();
      return;
    }
    if (bad_rows_++ == 0) first_bad_line_ = file_.line_number();
    if (bad_rows_ >= 1000 && bad_rows_ > builder_.points_read()) refuse();
  }

  /// In files that were joined, the names of the columns come again.
  bool repeats_names(std::string_view text) {
    ColumnNames names = read_column_names(text);
    if (names.slots.empty() || columns_named_) return false;
    leave_out_unused(names.slots);
    const bool counted = layout_.header_line != 0 && layout_.counter.has_value();
    if (counted) names.slots.insert(names.slots.begin(), kNoSlot);
    if (names.slots != layout_.slots) {
      throw ReadError(file_.name(), fmt::format("line {}", file_.line_number()),
                      fmt::format("it names the columns {}, but the rows before have {}",
                                  describe_columns(names.slots), describe_columns(layout_.slots)),
                      "split the file in two");
    }
    return true;
  }

  void note_columns() {
    std::string counter;
    if (layout_.counter && layout_.header_line == 0) {
      counter = fmt::format("; column {} numbers the points", *layout_.counter + 1);
      if (layout_.slots.size() == 4) {
        counter +=
            " (if northing comes before easting, the scan is mirrored; give --columns x=3,y=2,z=4)";
      }
    }
    std::string remark = layout_.remark.empty() ? "" : "; " + layout_.remark;
    if (layout_.has_commas) remark += "; commas are decimal commas";
    builder_.note(fmt::format("{}: columns {}, {}{}{}", file_.name(),
                              describe_columns(layout_.slots), layout_.source, counter, remark));
  }

  bool parse(std::string_view rest, PointRow& row) {
    std::string_view field;
    for (std::size_t i = 0; i < layout_.slots.size(); ++i) {
      const Slot slot = layout_.slots[i];
      if (!take_field(rest, layout_.style.separator, field)) return false;
      if (layout_.counter == i) count_row(field);
      if (slot != kNoSlot && !parse_field(field, layout_.style.decimal_comma, row[slot]))
        return false;
    }
    return true;
  }

  /// PTS files may hold several scans, each preceded by its count.
  bool is_count(std::string_view text) {
    std::int64_t count = 0;
    if (!parse_integer(text, count) || count < 0) return false;
    if (file_.line_number() < layout_.first_row_line) return true;
    declared_ += static_cast<std::uint64_t>(count);
    return true;
  }

  /// The column that numbers the points must do so in all rows, not only in the first rows.
  void count_row(std::string_view field) {
    std::int64_t number = 0;
    if (!parse_integer(field, number) || number <= last_number_) {
      if (uncounted_++ == 0) first_uncounted_line_ = file_.line_number();
    }
    last_number_ = number;
  }

  void check_counter() const {
    if (uncounted_ * 100 <= builder_.points_read()) return;
    throw ReadError(
        file_.name(), fmt::format("line {}", first_uncounted_line_),
        fmt::format(
            "column 1 numbers the first rows, but not {} of {} rows; it may be a coordinate",
            uncounted_, builder_.points_read()),
        "name the columns, as in --columns x=1,y=2,z=3 or --columns x=2,y=3,z=4");
  }

  /// Counts the last rows if they consist of three different integers, which may be faces.
  void count_integers(const PointRow& row) {
    const double x = row[kX];
    const double y = row[kY];
    const double z = row[kZ];
    const bool whole = x == std::floor(x) && y == std::floor(y) && z == std::floor(z);
    if (!whole) {
      last_integers_ = 0;
      return;
    }
    const bool corners = x >= 0.0 && y >= 0.0 && z >= 0.0 && x != y && y != z && z != x;
    if (!corners) {
      last_integers_ = 0;
      ++other_integers_;
      return;
    }
    if (last_integers_++ == 0) first_integer_line_ = file_.line_number();
    ++integers_;
  }

  /// Faces may follow the points without a word between them.
  void check_faces() const {
    if (columns_named_) return;
    const std::uint64_t before = builder_.points_read() - last_integers_;
    const std::uint64_t integers_before = integers_ - last_integers_ + other_integers_;
    const bool many = last_integers_ >= 4 && 100 * last_integers_ > builder_.points_read();
    if (!many || before < 3 || 100 * integers_before > before) return;
    throw ReadError(file_.name(), fmt::format("line {}", first_integer_line_),
                    fmt::format("the last {} rows consist of whole numbers, unlike the {} rows "
                                "before them; they may be the faces of a mesh",
                                last_integers_, before),
                    "remove these rows, or save the mesh as PLY; if they are points, name the "
                    "columns, as in --columns x=1,y=2,z=3");
  }

  void drop_no_data() {
    const std::optional<double> z = heights_.find();
    if (!z) return;
    const std::size_t count = builder_.drop_height(*z);
    builder_.count_dropped("no_data", count);
    builder_.warn(fmt::format(
        "{} points with a z of {:.12g}, far from all others, were dropped: it seems to stand for "
        "missing data.",
        count, *z));
  }

  void check_bad_rows() {
    if (head_lines_ > 0) {
      builder_.warn(fmt::format("{} before the first row {} skipped, the first at line {}.",
                                head_lines_ == 1 ? "1 line" : fmt::format("{} lines", head_lines_),
                                head_lines_ == 1 ? "was" : "were", first_head_line_));
    }
    if (bad_rows_ == 0) return;
    if (bad_rows_ * 100 > bad_rows_ + builder_.points_read()) refuse();
    builder_.count_dropped("bad_row", bad_rows_);
    builder_.warn(
        bad_rows_ == 1
            ? fmt::format("1 row was dropped: line {} is not a point.", first_bad_line_)
            : fmt::format("{} rows were dropped: they are not points (the first at line {}).",
                          bad_rows_, first_bad_line_));
  }

  [[noreturn]] void refuse() const {
    throw ReadError(
        file_.name(), fmt::format("line {}", first_bad_line_),
        fmt::format(
            "the row is not a point, like {} of {} rows: numbers are expected in the columns "
            "{}",
            bad_rows_, bad_rows_ + builder_.points_read(), describe_columns(layout_.slots)),
        "the file is damaged, or not a list of points; export it again, or name its columns, as in "
        "--columns x=1,y=2,z=3");
  }

  std::string format_name() const {
    switch (layout_.style.separator) {
      case ',':
        return "text, separated by commas";
      case ';':
        return "text, separated by semicolons";
      default:
        return "text, separated by spaces";
    }
  }

  InputFile& file_;
  TextLayout layout_;
  bool columns_named_;  // named by the user
  std::uint64_t declared_;
  ScanBuilder builder_;
  NoDataHeight heights_;
  std::uint64_t bad_rows_ = 0;
  std::uint64_t first_bad_line_ = 0;
  std::int64_t last_number_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t uncounted_ = 0;
  std::uint64_t first_uncounted_line_ = 0;
  std::uint64_t head_lines_ = 0;  // text before the first row
  std::uint64_t first_head_line_ = 0;
  std::uint64_t integers_ = 0;        // rows of three different integers from 0
  std::uint64_t other_integers_ = 0;  // other rows of integers
  std::uint64_t last_integers_ = 0;   // of integers_, without another row after them
  std::uint64_t first_integer_line_ = 0;
};

}  // namespace

Scan read_text(InputFile& file, const ReadOptions& options) {
  return TextReader(file, options).read();
}

}  // namespace tactree::builder
