#pragma once
// Tables as structured NumPy arrays, and the arrays that users pass.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tactree/simulation/trace.hpp"
#include "tactree/telemetry/tick_table.hpp"

namespace tactree::python {

namespace py = pybind11;

enum class FieldType : std::uint8_t { kFloat64, kFloat32, kUint32, kInt32, kUint8, kInt8, kFlag };

struct Field {
  std::string name;
  FieldType type = FieldType::kFloat32;
};

/// The columns of a trace and of a recording. A state is its number, see core::State.
[[nodiscard]] const std::vector<Field>& trace_fields();
[[nodiscard]] const std::vector<Field>& tick_fields();

[[nodiscard]] py::dtype dtype_of(const std::vector<Field>& fields);

/// Rows that grow. Needs the interpreter's lock for to_array() only.
class ArrayTable {
 public:
  /// `fields` must outlive the table.
  explicit ArrayTable(const std::vector<Field>& fields);

  /// The values of a row, in the order of the fields. A double holds each of them exactly.
  void append(std::span<const double> values);
  [[nodiscard]] std::size_t rows() const { return bytes_.size() / row_bytes_; }

  /// Moves the rows to an array that owns them, without a copy.
  [[nodiscard]] py::array to_array() &&;

 private:
  const std::vector<Field>& fields_;
  std::size_t row_bytes_;
  std::vector<std::byte> bytes_;
};

/// An argument of numbers; a list or an array of another type is converted.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

enum class Values : std::uint8_t { kFinite, kAny };

/// Rows of `width` numbers. A single row may have one dimension. Throws support::UserError that
/// states the argument `name`, the shape or the row.
[[nodiscard]] std::span<const double> rows_of(const Doubles& array, std::size_t width,
                                              const char* name, Values values = Values::kFinite);

/// Moves the values to a read-only array of `shape` that owns them, without a copy.
template <class T>
[[nodiscard]] py::array_t<T> to_array(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto* const kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  py::array_t<T> array(std::move(shape), kept->data(), owner);
  return array;
}

/// A triple as an array of three float64.
[[nodiscard]] py::array_t<double> triple(const std::array<double, 3>& values);

/// Throws the exception of a signal handler, such as KeyboardInterrupt. Call it now and then
/// during long work, without the interpreter's lock.
void check_signals();

}  // namespace tactree::python
