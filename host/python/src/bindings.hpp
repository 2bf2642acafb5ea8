#pragma once
// The parts of the native module.

#include <pybind11/pybind11.h>

#include <nlohmann/json_fwd.hpp>

namespace tactree::python {

void add_model(pybind11::module_& module);
void add_build(pybind11::module_& module);
void add_simulation(pybind11::module_& module);
void add_board(pybind11::module_& module);
void add_tables(pybind11::module_& module);

/// Objects become dictionaries, arrays become lists.
[[nodiscard]] pybind11::object to_python(const nlohmann::json& json);

}  // namespace tactree::python
