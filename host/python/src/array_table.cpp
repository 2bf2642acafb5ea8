#include "array_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "tactree/support/user_error.hpp"

namespace tactree::python {
namespace {

struct Storage {
  const char* format;  // of NumPy
  std::size_t bytes;
};

Storage storage_of(FieldType type) {
  switch (type) {
    case FieldType::kFloat64:
      return {"<f8", 8};
    case FieldType::kFloat32:
      return {"<f4", 4};
    case FieldType::kUint32:
      return {"<u4", 4};
    case FieldType::kInt32:
      return {"<i4", 4};
    case FieldType::kUint8:
      return {"u1", 1};
    case FieldType::kInt8:
      return {"i1", 1};
    case FieldType::kFlag:
      break;
  }
  return {"?", 1};
}

std::size_t bytes_of(const std::vector<Field>& fields) {
  std::size_t sum = 0;
  for (const Field& field : fields) {
    sum += storage_of(field.type).bytes;
  }
  return sum;
}

template <class T>
void put(std::byte*& at, double value) {
  const T narrow = static_cast<T>(value);
  std::memcpy(at, &narrow, sizeof narrow);
  at += sizeof narrow;
}

void put(std::byte*& at, FieldType type, double value) {
  switch (type) {
    case FieldType::kFloat64:
      return put<double>(at, value);
    case FieldType::kFloat32:
      return put<float>(at, value);
    case FieldType::kUint32:
      return put<std::uint32_t>(at, value);
    case FieldType::kInt32:
      return put<std::int32_t>(at, value);
    case FieldType::kInt8:
      return put<std::int8_t>(at, value);
    case FieldType::kUint8:
    case FieldType::kFlag:
      return put<std::uint8_t>(at, value);
  }
}

FieldType type_of(simulation::TraceType type) {
  switch (type) {
    case simulation::TraceType::kFloat64:
      return FieldType::kFloat64;
    case simulation::TraceType::kFloat32:
      return FieldType::kFloat32;
    case simulation::TraceType::kFlag:
      return FieldType::kFlag;
    case simulation::TraceType::kState:
      return FieldType::kUint8;
    case simulation::TraceType::kUint32:
      return FieldType::kUint32;
    case simulation::TraceType::kInt32:
      break;
  }
  return FieldType::kInt32;
}

FieldType type_of(telemetry::ColumnType type) {
  switch (type) {
    case telemetry::ColumnType::kFloat64:
      return FieldType::kFloat64;
    case telemetry::ColumnType::kFloat32:
      return FieldType::kFloat32;
    case telemetry::ColumnType::kUint32:
      return FieldType::kUint32;
    case telemetry::ColumnType::kUint8:
      return FieldType::kUint8;
    case telemetry::ColumnType::kInt32:
      break;
  }
  return FieldType::kInt32;
}

template <class Column>
std::vector<Field> fields_of(const std::vector<Column>& columns) {
  std::vector<Field> fields;
  for (const Column& column : columns) {
    // A recording stores this flag as a byte.
    const bool flag = column.name == "in_contact";
    fields.push_back({column.name, flag ? FieldType::kFlag : type_of(column.type)});
  }
  return fields;
}

std::string shape_text(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", array.shape(i));
  }
  return "(" + text + (array.ndim() == 1 ? ",)" : ")");
}

}  // namespace

const std::vector<Field>& trace_fields() {
  static const std::vector<Field> kFields = fields_of(simulation::trace_columns());
  return kFields;
}

const std::vector<Field>& tick_fields() {
  static const std::vector<Field> kFields = fields_of(telemetry::columns());
  return kFields;
}

py::dtype dtype_of(const std::vector<Field>& fields) {
  py::list names;
  py::list formats;
  py::list offsets;
  std::size_t offset = 0;
  for (const Field& field : fields) {
    const Storage storage = storage_of(field.type);
    names.append(field.name);
    formats.append(storage.format);
    offsets.append(offset);
    offset += storage.bytes;
  }
  return {names, formats, offsets, static_cast<py::ssize_t>(offset)};
}

ArrayTable::ArrayTable(const std::vector<Field>& fields)
    : fields_(fields), row_bytes_(python::bytes_of(fields)) {}

void ArrayTable::append(std::span<const double> values) {
  const std::size_t begin = bytes_.size();
  bytes_.resize(begin + row_bytes_);
  std::byte* at = bytes_.data() + begin;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    put(at, fields_[i].type, values[i]);
  }
}

py::array ArrayTable::to_array() && {
  auto* const kept = new std::vector<std::byte>(std::move(bytes_));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<std::byte>*>(p); });
  return py::array(dtype_of(fields_), {static_cast<py::ssize_t>(kept->size() / row_bytes_)},
                   {static_cast<py::ssize_t>(row_bytes_)}, kept->data(), owner);
}

std::span<const double> rows_of(const Doubles& array, std::size_t width, const char* name,
                                Values allowed) {
  const auto columns = static_cast<py::ssize_t>(width);
  const bool one = array.ndim() == 1 && array.shape(0) == columns;
  if (!one && !(array.ndim() == 2 && array.shape(1) == columns)) {
    support::refuse(name, fmt::format("the shape {} is not (N, {})", shape_text(array), width),
                    fmt::format("give one row of {} numbers for each of them", width));
  }
  const std::span<const double> values(array.data(), static_cast<std::size_t>(array.size()));
  for (std::size_t i = 0; allowed == Values::kFinite && i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      support::refuse(fmt::format("{}[{}]", name, i / width), "is not finite",
                      "remove the row, or correct it");
    }
  }
  return values;
}

py::array_t<double> triple(const std::array<double, 3>& values) {
  return py::array_t<double>(3, values.data());
}

void check_signals() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) {
    throw py::error_already_set();
  }
}

}  // namespace tactree::python
