// The native module tactree._native: classes and functions that the modules of the package use.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "bindings.hpp"
#include "errors.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/builder/option_names.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/support/csv.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::python {
namespace {

namespace py = pybind11;

/// The classes of the package; references for the life of the interpreter.
struct Errors {
  PyObject* error = nullptr;
  PyObject* file = nullptr;
  PyObject* build = nullptr;
  PyObject* board = nullptr;
};
Errors errors;

PyObject* add_error(py::module_& module, const char* name, PyObject* base, const char* about) {
  const std::string full = std::string("tactree.") + name;
  PyObject* const type = PyErr_NewExceptionWithDoc(full.c_str(), about, base, nullptr);
  if (type == nullptr) {
    throw py::error_already_set();
  }
  module.add_object(name, py::handle(type));
  return type;
}

/// "--flash-budget" of the command line is flash_budget here.
std::string option_sentence(const builder::OptionError& error) {
  std::string name = error.option();
  for (char& c : name) {
    c = c == '-' ? '_' : c;
  }
  return name + ": " + error.what();
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const builder::OptionError& error) {
    PyErr_SetString(errors.error, option_sentence(error).c_str());
  } catch (const FileFailure& error) {
    PyErr_SetString(errors.file, error.what());
  } catch (const support::CsvError& error) {
    PyErr_SetString(errors.file, error.what());
  } catch (const builder::ReadError& error) {
    PyErr_SetString(errors.file, error.what());
  } catch (const builder::BuildError& error) {
    PyErr_SetString(errors.build, error.what());
  } catch (const client::LinkError& error) {
    PyErr_SetString(errors.board, error.what());
  } catch (const std::invalid_argument& error) {
    PyErr_SetString(errors.error, error.what());
  } catch (const std::runtime_error& error) {
    PyErr_SetString(errors.error, error.what());
  }
}

void add_errors(py::module_& module) {
  errors.error = add_error(module, "Error", PyExc_Exception,
                           "Something was refused or failed. The text states the place, the cause "
                           "and a hint.");
  errors.file = add_error(module, "FileError", errors.error,
                          "A file is damaged, of another kind, or cannot be read or written.");
  errors.build =
      add_error(module, "BuildError", errors.error, "No model can be built from these points.");
  errors.board = add_error(module, "BoardError", errors.error,
                           "A port or board refused a request, does not answer, or is gone.");
  py::register_local_exception_translator(translate);
}

py::tuple state_names() {
  py::list names;
  for (std::uint32_t i = 0; i < core::kStates; ++i) {
    names.append(core::name_of(static_cast<core::State>(i)));
  }
  return py::tuple(names);
}

py::dict fault_names() {
  py::dict names;
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    names[py::int_(code)] = core::name_of(fault);
  }
  return names;
}

py::tuple names_of_faults(core::FaultMask mask) {
  py::list names;
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    if (const auto fault = static_cast<core::Fault>(code); core::has_fault(mask, fault)) {
      names.append(core::name_of(fault));
    }
  }
  return py::tuple(names);
}

py::tuple names_of_limits(core::LimitMask mask) {
  py::list names;
  for (std::uint32_t i = 0; i < core::kLimits; ++i) {
    if ((mask & (1U << i)) != 0U) {
      names.append(core::name_of(static_cast<core::Limit>(1U << i)));
    }
  }
  return py::tuple(names);
}

}  // namespace

py::object to_python(const nlohmann::json& json) {
  if (json.is_object()) {
    py::dict dict;
    for (const auto& [key, value] : json.items()) {
      dict[py::str(key)] = to_python(value);
    }
    return dict;
  }
  if (json.is_array()) {
    py::list list;
    for (const nlohmann::json& value : json) {
      list.append(to_python(value));
    }
    return list;
  }
  if (json.is_boolean()) return py::bool_(json.get<bool>());
  if (json.is_number_unsigned()) return py::int_(json.get<std::uint64_t>());
  if (json.is_number_integer()) return py::int_(json.get<std::int64_t>());
  if (json.is_number()) return py::float_(json.get<double>());
  if (json.is_string()) {
    // Names of files and models may contain bytes that are not UTF-8.
    const auto& text = json.get_ref<const std::string&>();
    PyObject* const decoded =
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
    return py::reinterpret_steal<py::object>(decoded);
  }
  return py::none();
}

}  // namespace tactree::python

// The name of this variable is shown in signatures.
PYBIND11_MODULE(_native, module) {
  namespace python = tactree::python;
  module.doc() = "The native part of the package tactree; use the package itself.";
  module.attr("__version__") = TACTREE_VERSION;
  python::add_errors(module);
  module.attr("STATES") = python::state_names();
  module.attr("FAULTS") = python::fault_names();
  module.def("fault_names", python::names_of_faults, pybind11::arg("mask"),
             "The names of the faults in a mask.");
  module.def("limit_names", python::names_of_limits, pybind11::arg("mask"),
             "The names of the limits in a mask.");
  module.def(
      "device_names",
      [] { return pybind11::tuple(pybind11::cast(tactree::support::device_names())); },
      "The names of all device presets.");
  python::add_model(module);
  python::add_build(module);
  python::add_simulation(module);
  python::add_board(module);
  python::add_tables(module);
}
