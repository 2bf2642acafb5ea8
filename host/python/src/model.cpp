#include "model.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "array_table.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/support/blob_facts.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/point_query.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::python {
namespace {

// Positions between two checks for Ctrl-C; some hundredths of a second.
constexpr std::size_t kBatch = 4096;

/// The columns of `tactree query`.
const std::vector<Field>& answer_fields() {
  using enum FieldType;
  static const std::vector<Field> kFields{{"x", kFloat32},          {"y", kFloat32},
                                          {"z", kFloat32},          {"contact_paper", kFlag},
                                          {"contact", kFlag},       {"nearest", kInt32},
                                          {"distance_m", kFloat64}, {"surface_x", kFloat32},
                                          {"surface_y", kFloat32},  {"surface_z", kFloat32},
                                          {"normal_x", kFloat32},   {"normal_y", kFloat32},
                                          {"normal_z", kFloat32},   {"signed_distance_m", kFloat32},
                                          {"inside", kInt8}};
  return kFields;
}

core::Vec3 narrow(std::span<const double> row) {
  return {static_cast<float>(row[0]), static_cast<float>(row[1]), static_cast<float>(row[2])};
}

std::array<double, 15> values_of(core::Vec3 probe, const support::PointAnswer& a) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 15> row{};
  row.fill(kNone);
  row[0] = static_cast<double>(probe.x);
  row[1] = static_cast<double>(probe.y);
  row[2] = static_cast<double>(probe.z);
  row[3] = a.contact_paper ? 1.0 : 0.0;
  row[4] = a.contact ? 1.0 : 0.0;
  row[5] = a.nearest == core::kNoPoint ? -1.0 : static_cast<double>(a.nearest);
  if (a.nearest != core::kNoPoint) {
    row[6] = a.distance_m;
  }
  if (a.surface.supported) {
    const core::SurfaceProjection& s = a.surface;
    row[7] = static_cast<double>(s.point.x);
    row[8] = static_cast<double>(s.point.y);
    row[9] = static_cast<double>(s.point.z);
    row[10] = static_cast<double>(s.normal.x);
    row[11] = static_cast<double>(s.normal.y);
    row[12] = static_cast<double>(s.normal.z);
    row[13] = static_cast<double>(s.signed_distance);
  }
  row[14] = a.inside ? (*a.inside ? 1.0 : 0.0) : -1.0;
  return row;
}

float radius_of(const Model& model, std::optional<double> radius_m) {
  if (!radius_m) {
    return support::default_query_radius_m(model.view());
  }
  if (!(*radius_m >= 0.0) || !std::isfinite(*radius_m)) {
    support::refuse("radius_m", "must not be negative", "give a length in metres");
  }
  return static_cast<float>(*radius_m);
}

py::array query(const Model& model, const Doubles& positions, std::optional<double> radius_m) {
  const std::span<const double> rows = rows_of(positions, 3, "positions");
  const float radius = radius_of(model, radius_m);
  ArrayTable table(answer_fields());
  {
    const py::gil_scoped_release unlocked;
    support::PointQuery engine(model.view(), radius);
    for (std::size_t i = 0; i < rows.size(); i += 3) {
      if (i / 3 % kBatch == kBatch - 1) {
        check_signals();
      }
      const core::Vec3 probe = narrow(rows.subspan(i, 3));
      table.append(values_of(probe, engine.answer(probe)));
    }
  }
  return std::move(table).to_array();
}

support::BlobFile read_blob(const std::filesystem::path& file) {
  try {
    const py::gil_scoped_release unlocked;
    return support::BlobFile(file);
  } catch (const support::UserError& error) {
    throw FileFailure(error.what());
  }
}

py::dict info(const Model& model) {
  nlohmann::json facts = support::blob_facts(model.view());
  facts["warnings"] = nlohmann::json::array();
  if (const auto warning = setup::size_warning(model.file(), model.view().header())) {
    facts["warnings"].push_back(*warning);
  }
  return to_python(facts);
}

py::array_t<double> bounds(const Model& model) {
  const core::BlobHeader& h = model.view().header();
  std::vector<double> values;
  for (const float* const corner : {h.bounds_min_m, h.bounds_max_m}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      values.push_back(support::shortest_double(corner[axis]));
    }
  }
  return to_array(std::move(values), {2, 3});
}

/// A view of bytes of the blob, which the array keeps alive.
template <class T>
py::array part_of(const Model& model, std::size_t offset, std::size_t count) {
  const py::capsule owner(new std::shared_ptr(model.blob()), [](void* p) {
    delete static_cast<std::shared_ptr<const support::BlobFile>*>(p);
  });
  py::array_t<T> array(static_cast<py::ssize_t>(count),
                       reinterpret_cast<const T*>(model.bytes().data() + offset), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::object point_materials(const Model& model) {
  const core::BlobSection& section = model.view().header().material_indices;
  if (section.bytes == 0) {
    return py::none();
  }
  return part_of<std::uint8_t>(model, section.offset, model.view().point_count());
}

void save(const Model& model, const std::filesystem::path& file) {
  try {
    const py::gil_scoped_release unlocked;
    support::check_outputs({file});
    support::write_file(file, model.bytes());
  } catch (const support::UserError& error) {
    throw FileFailure(error.what());
  }
}

}  // namespace

void Model::decode() {
  std::vector<float> points;
  std::vector<float> normals;
  {
    const py::gil_scoped_release unlocked;
    const core::BlobView& blob = view();
    points.reserve(3U * blob.point_count());
    normals.reserve(3U * blob.point_count());
    core::for_each_point(blob, [&](const core::Leaf& leaf, std::uint32_t index) {
      const core::SurfacePoint p = blob.surface_point(leaf, index);
      points.insert(points.end(), {p.position.x, p.position.y, p.position.z});
      normals.insert(normals.end(), {p.normal.x, p.normal.y, p.normal.z});
    });
  }
  if (points_) {
    return;  // another thread was faster
  }
  const auto count = static_cast<py::ssize_t>(points.size() / 3);
  points_ = to_array(std::move(points), {count, 3});
  normals_ = to_array(std::move(normals), {count, 3});
  for (const py::object& array : {points_, normals_}) {
    array.attr("setflags")(py::arg("write") = false);
  }
}

py::array Model::points() {
  if (!points_) {
    decode();
  }
  return points_;
}

py::array Model::normals() {
  if (!normals_) {
    decode();
  }
  return normals_;
}

void add_model(py::module_& module) {
  py::class_<Model> model(module, "Model");
  model.def("points", &Model::points, "Positions (N, 3), m, float32; decoded once; read-only.");
  model.def("normals", &Model::normals, "Normals (N, 3), float32; decoded once; read-only.");
  model.def(
      "data", [](const Model& m) { return part_of<std::uint8_t>(m, 0, m.bytes().size()); },
      "The bytes of the blob, without a copy; read-only.");
  model.def(
      "point_materials", point_materials,
      "Index of the material of each point, without a copy; None without materials per point.");
  model.def("info", info, "The facts of tactree info.");
  model.def("bounds", bounds, "Lower and upper corner (2, 3), m.");
  model.def(
      "report", [](const Model& m) { return m.report(); },
      "The report of the build as JSON; empty if the model was loaded.");
  model.def(
      "file", [](const Model& m) { return m.file(); }, "Name in messages.");
  model.def("query", query, py::arg("positions"), py::arg("radius_m") = py::none(),
            "The table of tactree query.");
  model.def("save", save, py::arg("path"), "Writes the blob.");
  module.def(
      "load",
      [](const std::filesystem::path& path) { return Model(read_blob(path), path.string()); },
      py::arg("path"), "Reads and checks a blob.");
  module.def(
      "from_bytes",
      [](const py::bytes& data, const std::string& name) {
        const std::string_view text(data);
        try {
          return Model(support::BlobFile::copy_of(std::as_bytes(std::span(text)), name), name);
        } catch (const support::UserError& error) {
          throw FileFailure(error.what());
        }
      },
      py::arg("data"), py::arg("name"), "Copies and checks a blob.");
}

}  // namespace tactree::python
