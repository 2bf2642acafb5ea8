// tactree.build and tactree.build_file.

#include <fmt/format.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "array_table.hpp"
#include "bindings.hpp"
#include "model.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/builder/option_names.hpp"
#include "tactree/builder/read_materials.hpp"
#include "tactree/builder/report_json.hpp"
#include "tactree/setup/pose_file.hpp"
#include "tactree/setup/session.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::python {
namespace {

using builder::BuildOptions;

/// Calls a function of the user, and lets Ctrl-C end the build.
class CalledProgress final : public builder::Progress {
 public:
  explicit CalledProgress(py::object call) : call_(std::move(call)) {}

  void begin(std::string_view name) override {
    name_ = name;
    advance(0.0);
  }
  void advance(double fraction) override {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) {
      throw py::error_already_set();
    }
    if (!call_.is_none()) {
      call_(name_, fraction);
    }
  }
  void end() override {}

 private:
  py::object call_;
  std::string name_;
};

/// The options of the user: a dictionary without the values that are None.
class Options {
 public:
  explicit Options(const py::dict& values) : values_(values) {}

  template <class T>
  void read(const char* name, T& value) const {
    if (values_.contains(name)) {
      value = cast<T>(name);
    }
  }
  template <class T>
  void read(const char* name, std::optional<T>& value) const {
    if (values_.contains(name)) {
      value = cast<T>(name);
    }
  }
  /// A value by its name.
  template <class T, class Target>
  void choose(const char* name, const std::map<std::string, T>& names, Target& value) const {
    if (!values_.contains(name)) {
      return;
    }
    const auto text = cast<std::string>(name);
    const auto found = names.find(text);
    if (found == names.end()) {
      std::string list;
      for (const auto& [known, _] : names) {
        list += (list.empty() ? "" : ", ") + known;
      }
      support::refuse(name, fmt::format("'{}' is unknown", text), "one of: " + list);
    }
    value = found->second;
  }
  [[nodiscard]] bool has(const char* name) const { return values_.contains(name); }
  template <class T>
  [[nodiscard]] T cast(const char* name) const {
    try {
      return values_[name].cast<T>();
    } catch (const py::cast_error&) {
      support::refuse(name,
                      fmt::format("{} cannot be used", py::repr(values_[name]).cast<std::string>()),
                      "help(tactree.build) describes the value");
    }
  }

 private:
  const py::dict& values_;
};

/// Refuses options of which one would have no effect.
void refuse_both(const Options& options, const char* one, const char* other) {
  if (options.has(one) && options.has(other)) {
    support::refuse(one, fmt::format("excludes {}", other), "give one of them");
  }
}

void read_frame(const Options& options, BuildOptions& build) {
  refuse_both(options, "fit_m", "fit_device");
  refuse_both(options, "fit_m", "scale");
  refuse_both(options, "fit_device", "scale");
  options.choose("unit", builder::unit_names(), build.unit_m);
  options.choose("axis", builder::axis_names(), build.up);
  options.read("turn_deg", build.turn_deg);
  if (options.has("pose")) {
    const simulation::Placement placement =
        setup::read_pose_file(options.cast<std::string>("pose"));
    build.pose = placement.pose;
    build.placed_scale = placement.scale;
  }
  options.read("scale", build.scale);
  options.read("centre", build.centre);
  options.read("fit_m", build.fit_m);
  if (options.has("fit_device")) {
    build.fit_edge_m = setup::fit_to_device(options.cast<std::string>("fit_device"));
  }
  if (options.has("crop")) {
    const auto box = options.cast<Doubles>("crop");
    const std::span<const double> c = rows_of(box, 6, "crop");
    build.crop =
        Eigen::AlignedBox3d(Eigen::Vector3d(c[0], c[1], c[2]), Eigen::Vector3d(c[3], c[4], c[5]));
  }
}

void read_surface(const Options& options, BuildOptions& build) {
  options.choose("orient", builder::orientation_names(), build.orient);
  options.choose("profile", builder::profile_names(), build.profile);
  options.read("outliers", build.outlier_sigma);
  options.read("keep_largest", build.keep_largest);
  options.read("min_piece", build.min_piece);
  if (build.keep_largest) {
    refuse_both(options, "keep_largest", "min_piece");
  }
  options.read("flip_normals", build.flip_normals);
  options.read("two_sided_m", build.two_sided_m);
  options.read("spacing_m", build.spacing_m);
  options.read("resample", build.resample);
  options.read("flash_budget", build.flash_budget_bytes);
  options.read("memory_limit", build.memory_limit_bytes);
  if (options.has("viewpoints")) {
    const auto places = options.cast<Doubles>("viewpoints");
    const std::span<const double> rows = rows_of(places, 3, "viewpoints");
    for (std::size_t i = 0; i < rows.size(); i += 3) {
      build.viewpoints.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
    }
  }
}

BuildOptions read_options(const py::dict& values) {
  const Options options(values);
  BuildOptions build;
  read_frame(options, build);
  read_surface(options, build);
  options.read("name", build.name);
  options.read("threads", build.threads);
  options.read("format", build.format);
  if (options.has("columns")) {
    try {
      build.columns = builder::parse_columns(options.cast<std::string>("columns"));
    } catch (const std::invalid_argument& error) {
      throw builder::OptionError("columns", error.what());
    }
  }
  builder::check_options(build);
  if (options.has("material")) {
    build.materials = builder::read_materials(options.cast<std::string>("material"));
  }
  return build;
}

Model model_of(const builder::BuildResult& result, const BuildOptions& options,
               const std::string& name) {
  return {support::BlobFile::copy_of(result.blob.bytes, name), name,
          builder::report_json(result.report, options)};
}

Model build_files(const std::vector<std::filesystem::path>& paths, const py::dict& values,
                  py::object progress) {
  const BuildOptions options = read_options(values);
  CalledProgress called(std::move(progress));
  const py::gil_scoped_release unlocked;
  const builder::BuildResult result = builder::build_model(paths, options, called);
  return model_of(result, options, result.report.inputs.front().file);
}

std::size_t same_length(std::size_t rows, std::size_t points, const char* name) {
  if (rows != points) {
    support::refuse(name, fmt::format("{} rows for {} points", rows, points),
                    "give one row for each point");
  }
  return rows;
}

/// Throws UserError if `value`, of the named row, is not a whole number from 0 to `most`.
std::uint32_t whole_number(double value, double most, const char* name, py::ssize_t row,
                           const char* remedy) {
  if (!(value >= 0.0 && value <= most) || value != std::floor(value)) {
    support::refuse(fmt::format("{}[{}]", name, row),
                    fmt::format("{:.6g} is not a whole number from 0 to {:.0f}", value, most),
                    remedy);
  }
  return static_cast<std::uint32_t>(value);
}

void add_colours(const Doubles& colours, builder::Scan& scan) {
  if (colours.ndim() != 2 || colours.shape(1) != 3) {
    support::refuse("colors", "the shape is not (N, 3)", "give red, green and blue of each point");
  }
  (void)same_length(static_cast<std::size_t>(colours.shape(0)), scan.positions.size(), "colors");
  const auto rows = colours.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    std::array<std::uint8_t, 3> colour{};
    for (py::ssize_t c = 0; c < 3; ++c) {
      colour[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(
          whole_number(rows(i, c), 255.0, "colors", i,
                       "give colours of 8 bits; those of 0 .. 1 times 255, rounded"));
    }
    scan.colours.push_back(colour);
  }
}

void add_triangles(const Doubles& triangles, builder::Scan& scan) {
  if (triangles.ndim() != 2 || triangles.shape(1) != 3) {
    support::refuse("triangles", "the shape is not (N, 3)",
                    "give three indices of points for each");
  }
  const auto rows = triangles.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    std::array<std::uint32_t, 3> corners{};
    for (py::ssize_t c = 0; c < 3; ++c) {
      corners[static_cast<std::size_t>(c)] =
          whole_number(rows(i, c), static_cast<double>(scan.positions.size()) - 1.0, "triangles", i,
                       "give the indices of points, from 0");
    }
    scan.triangles.push_back(corners);
  }
}

/// As the readers of files do.
void drop_non_finite(builder::Scan& scan) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    if (!scan.positions[i].allFinite()) {
      if (scan.is_mesh()) {
        support::refuse(fmt::format("points[{}]", i), "is not finite",
                        "correct the vertex, or remove its triangles");
      }
      continue;
    }
    scan.positions[kept] = scan.positions[i];
    if (!scan.normals.empty()) {
      scan.normals[kept] = scan.normals[i];
    }
    if (!scan.colours.empty()) {
      scan.colours[kept] = scan.colours[i];
    }
    ++kept;
  }
  if (kept < scan.positions.size()) {
    scan.dropped["non_finite"] = scan.positions.size() - kept;
    scan.positions.resize(kept);
    scan.normals.resize(std::min(kept, scan.normals.size()));
    scan.colours.resize(std::min(kept, scan.colours.size()));
  }
}

builder::Scan scan_of(const Doubles& points, const std::optional<Doubles>& normals,
                      const std::optional<Doubles>& colours,
                      const std::optional<Doubles>& triangles) {
  builder::Scan scan;
  scan.format = "arrays";
  const std::span<const double> rows = rows_of(points, 3, "points", Values::kAny);
  if (rows.empty()) {
    support::refuse("points", "there are none", "give at least one row");
  }
  for (std::size_t i = 0; i < rows.size(); i += 3) {
    scan.positions.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
  }
  if (normals) {
    const std::span<const double> n = rows_of(*normals, 3, "normals", Values::kAny);
    (void)same_length(n.size() / 3, scan.positions.size(), "normals");
    for (std::size_t i = 0; i < n.size(); i += 3) {
      const Eigen::Vector3d normal(n[i], n[i + 1], n[i + 2]);
      scan.normals.emplace_back(Eigen::Vector3f::Zero());
      if (normal.allFinite()) {
        scan.normals.back() = normal.cast<float>();
      }
    }
  }
  if (colours) {
    add_colours(*colours, scan);
  }
  if (triangles) {
    add_triangles(*triangles, scan);
  }
  drop_non_finite(scan);
  return scan;
}

Model build_arrays(const Doubles& points, const std::optional<Doubles>& normals,
                   const std::optional<Doubles>& colours, const std::optional<Doubles>& triangles,
                   const py::dict& values, py::object progress) {
  const BuildOptions options = read_options(values);
  std::vector<builder::Scan> scans;
  scans.push_back(scan_of(points, normals, colours, triangles));
  CalledProgress called(std::move(progress));
  const py::gil_scoped_release unlocked;
  const builder::BuildResult result = builder::build_model(std::move(scans), options, called);
  return model_of(result, options, options.name);
}

}  // namespace

void add_build(py::module_& module) {
  module.def("build_arrays", build_arrays, py::arg("points"), py::arg("normals"), py::arg("colors"),
             py::arg("triangles"), py::arg("options"), py::arg("progress"),
             "Builds a model from arrays.");
  module.def("build_files", build_files, py::arg("paths"), py::arg("options"), py::arg("progress"),
             "Builds a model from files.");
  module.def(
      "units", [] { return builder::unit_names(); }, "Metres per unit, by its name.");
}

}  // namespace tactree::python
