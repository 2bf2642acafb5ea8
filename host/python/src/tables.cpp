// tactree.read_trace and tactree.read_recording: tables in files as structured arrays.

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "array_table.hpp"
#include "bindings.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/support/csv.hpp"

namespace tactree::python {
namespace {

// Rows between two checks for Ctrl-C; some hundredths of a second.
constexpr std::size_t kRowsPerBatch = 10000;

/// Reads a CSV file with these columns, in any order. Further columns are ignored. Float32 columns
/// that an older version did not write are NaN.
class TableReader {
 public:
  TableReader(const std::filesystem::path& file, const std::vector<Field>& fields,
              const char* remedy)
      : table_(file, {.header = support::CsvHeader::kRequired}), fields_(fields), remedy_(remedy) {
    for (const Field& field : fields) {
      const std::optional<std::size_t> column = table_.find_column(field.name);
      if (!column && field.type != FieldType::kFloat32) {
        table_.refuse("the header has no column " + field.name, remedy_);
      }
      columns_.push_back(column);
    }
  }

  void read(ArrayTable& rows) {
    std::vector<double> values(fields_.size());
    while (table_.next_row()) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!columns_[i]) {
          values[i] = std::numeric_limits<double>::quiet_NaN();
        } else {
          values[i] = fields_[i].name == "state" ? state(*columns_[i]) : number(i);
        }
      }
      rows.append(values);
      if (rows.rows() % kRowsPerBatch == 0) {
        check_signals();
      }
    }
  }

 private:
  /// A number that its type holds. NaN and infinity are not accepted.
  [[nodiscard]] double number(std::size_t field) const {
    const double value = table_.number(*columns_[field]);
    const auto [low, high] = range_of(fields_[field].type);
    if (!(value >= low && value <= high)) {
      table_.refuse(
          fmt::format("{}: {} is outside {:.0f} .. {:.0f}", fields_[field].name, value, low, high),
          remedy_);
    }
    return value;
  }

  static std::pair<double, double> range_of(FieldType type) {
    switch (type) {
      case FieldType::kUint32:
        return {0.0, 4294967295.0};
      case FieldType::kInt32:
        return {-2147483648.0, 2147483647.0};
      case FieldType::kUint8:
        return {0.0, 255.0};
      case FieldType::kInt8:
        return {-128.0, 127.0};
      case FieldType::kFlag:
        return {0.0, 1.0};
      case FieldType::kFloat32:
      case FieldType::kFloat64:
        break;
    }
    return {-1e300, 1e300};
  }

  [[nodiscard]] double state(std::size_t column) const {
    for (std::uint32_t i = 0; i < core::kStates; ++i) {
      if (table_.cells()[column] == core::name_of(static_cast<core::State>(i))) {
        return i;
      }
    }
    table_.refuse(fmt::format("state: '{}' is unknown", table_.cells()[column]), remedy_);
  }

  support::CsvReader table_;
  const std::vector<Field>& fields_;
  const char* remedy_;
  std::vector<std::optional<std::size_t>> columns_;
};

py::array read_table(const std::filesystem::path& file, const std::vector<Field>& fields,
                     const char* remedy) {
  ArrayTable rows(fields);
  {
    const py::gil_scoped_release unlocked;
    TableReader(file, fields, remedy).read(rows);
  }
  return std::move(rows).to_array();
}

}  // namespace

void add_tables(py::module_& module) {
  module.def(
      "read_trace",
      [](const std::filesystem::path& path) {
        return read_table(path, trace_fields(), "give a file written by simulate --trace");
      },
      py::arg("path"), "The rows of a trace.");
  module.def(
      "read_ticks",
      [](const std::filesystem::path& path) {
        return read_table(path, tick_fields(), "give a file written by tactree record");
      },
      py::arg("path"), "The rows of a recording in CSV.");
  module.def(
      "tick_dtype", [] { return dtype_of(tick_fields()); }, "The columns of a recording.");
}

}  // namespace tactree::python
