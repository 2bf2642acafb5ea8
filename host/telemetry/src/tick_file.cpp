#include "tactree/telemetry/tick_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <string>

#include "npz_writer.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

namespace fs = std::filesystem;

class CsvFile final : public TickFile {
 public:
  CsvFile(const fs::path& file, std::uint32_t fields)
      : fields_(fields), columns_(columns_of(fields)), file_(file) {
    std::string heading;
    for (const Column& column : columns_) {
      heading += (heading.empty() ? "" : ",") + column.name;
    }
    file_.append(heading + "\n");
  }

  void append(std::span<const Tick> ticks) override {
    std::string rows;
    for (const Tick& tick : ticks) {
      append_row(tick, rows);
    }
    file_.append(rows);
  }
  void finish() override { file_.finish(); }

 private:
  void append_row(const Tick& tick, std::string& rows) {
    values_of(tick, values_, fields_);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      rows += i == 0 ? "" : ",";
      append_cell(columns_[i], values_[i], rows);
    }
    rows += '\n';
  }

  static void append_cell(const Column& column, double value, std::string& rows) {
    const auto out = std::back_inserter(rows);
    if (!column.words.empty()) {
      rows += column.words[static_cast<std::size_t>(value)];
    } else if (column.type == ColumnType::kFloat64) {
      fmt::format_to(out, "{:.6f}", value);  // microseconds
    } else if (column.type == ColumnType::kFloat32) {
      fmt::format_to(out, "{:.9g}", value);
    } else {
      fmt::format_to(out, "{}", static_cast<std::int64_t>(value));
    }
  }

  std::uint32_t fields_;
  std::vector<Column> columns_;
  support::GrowingFile file_;
  std::vector<double> values_;
};

class NpzFile final : public TickFile {
 public:
  NpzFile(const fs::path& file, std::uint32_t fields)
      : fields_(fields), file_(file, columns_of(fields)) {}

  void append(std::span<const Tick> ticks) override {
    for (const Tick& tick : ticks) {
      values_of(tick, values_, fields_);
      file_.append(values_);
    }
  }
  void finish() override { file_.finish(); }

 private:
  std::uint32_t fields_;
  NpzWriter file_;
  std::vector<double> values_;
};

}  // namespace

void check_tick_file(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".rec") {
    support::refuse(file.string(),
                    "a .rec holds the encoder counts and requests of a session, which telemetry "
                    "does not include, so a board's telemetry cannot be replayed",
                    "record to .csv or .npz; simulate --record writes a .rec");
  }
  if (extension != ".csv" && extension != ".npz" && !support::is_written_in_place(file)) {
    support::refuse(file.string(), "the name ends with neither .csv nor .npz",
                    "the ending chooses the format");
  }
  if (extension == ".npz" && support::is_written_in_place(file)) {
    support::refuse(file.string(), "an archive cannot be written to a device or pipe",
                    "give a file, or a name that ends with .csv");
  }
}

std::unique_ptr<TickFile> open_tick_file(const fs::path& file, std::uint32_t fields) {
  check_tick_file(file);
  if (file.extension() == ".npz") {
    return std::make_unique<NpzFile>(file, fields);
  }
  return std::make_unique<CsvFile>(file, fields);
}

}  // namespace tactree::telemetry
