// tactree.Simulation: the session of `tactree simulate`, tick by tick.

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "array_table.hpp"
#include "bindings.hpp"
#include "model.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/setup/pose_file.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/setup/session.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/scene_target.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::python {
namespace {

using simulation::Sample;
using Counts = std::array<double, core::kAxes>;

// Ticks between two checks for Ctrl-C; some hundredths of a second.
constexpr std::uint64_t kTicksPerBatch = 1000;
// As for a trace of the tool, which also keeps every tick in memory.
constexpr double kMaxTicks = 5e6;

/// Values of the user: a dictionary without those that are None.
template <class T>
void read(const py::dict& values, const char* name, T& value) {
  if (values.contains(name)) {
    try {
      value = values[name].cast<T>();
    } catch (const py::cast_error&) {
      support::refuse(name,
                      fmt::format("{} cannot be used", py::repr(values[name]).cast<std::string>()),
                      "help(tactree.Simulation) describes the value");
    }
  }
}

void read_plant(const py::dict& values, setup::SessionOptions& options) {
  plant::PlantParameters& plant = options.setup.plant;
  read(values, "device_mass_kg", plant.device.mass_kg);
  read(values, "device_friction_N", plant.device.coulomb_N);
  read(values, "encoder_step_m", options.encoder_step_m);
  read(values, "latency_ticks", options.latency_ticks);
  read(values, "hand_stiffness_N_m", plant.hand.stiffness_N_m);
  read(values, "hand_damping_Ns_m", plant.hand.damping_Ns_m);
  read(values, "hand_mass_kg", plant.hand.mass_kg);
}

setup::SessionOptions session_options_of(const py::dict& values) {
  setup::SessionOptions options;
  core::Configuration& c = options.setup.controller;
  read(values, "device", options.device);
  read(values, "rate_hz", c.rate_hz);
  read(values, "stiffness_N_m", c.contact.stiffness_N_m);
  read(values, "damping_Ns_m", c.contact.damping_Ns_m);
  read(values, "static_friction", c.contact.static_friction);
  read(values, "dynamic_friction", c.contact.dynamic_friction);
  read(values, "texture_height_m", c.contact.texture_height_m);
  read(values, "texture_wavelength_m", c.contact.texture_wavelength_m);
  read(values, "passivity_Ns_m", c.passivity_Ns_m);
  read(values, "use_materials", c.use_materials);
  read(values, "first_force", options.first_force);
  read(values, "origin_m", options.origin_m);
  read_plant(values, options);
  if (values.contains("force_max_N")) {
    float force_max_N = 0.0F;
    read(values, "force_max_N", force_max_N);
    options.force_max_N = force_max_N;
  }
  read(values, "mode", options.mode);
  if (options.mode != "surface" && options.mode != "paper") {
    support::refuse("mode", fmt::format("'{}' is unknown", options.mode), "one of: surface, paper");
  }
  if (!options.origin_m.empty() && options.origin_m.size() != 3) {
    support::refuse("origin_m", "is not three numbers", "give x, y and z in metres");
  }
  if (!(options.latency_ticks >= 0.0 && options.latency_ticks <= hal::sim::kMaxLatencyTicks)) {
    support::refuse("latency_ticks", "is out of range",
                    fmt::format("give 0 .. {}", hal::sim::kMaxLatencyTicks));
  }
  return options;
}

/// Where the user has placed the model: a file, or the rows of a matrix and a scale.
std::optional<simulation::Placement> read_placement(const py::dict& values) {
  if (values.contains("pose_file")) {
    std::string file;
    read(values, "pose_file", file);
    return setup::read_pose_file(file);
  }
  if (!values.contains("pose")) {
    return std::nullopt;
  }
  std::vector<double> rows;
  double scale = 1.0;
  read(values, "pose", rows);
  read(values, "scale", scale);
  return setup::placement_of({{"pose", rows}, {"scale", scale}}, "Simulation");
}

std::vector<simulation::InjectedFault> read_faults(const std::vector<std::string>& texts) {
  std::vector<simulation::InjectedFault> faults;
  for (const std::string& text : texts) {
    faults.push_back(simulation::parse_injection(text));
  }
  return faults;
}

std::array<double, 3> widened(core::Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

class Session {
 public:
  Session(const Model& model, const py::dict& values, const std::vector<std::string>& faults)
      : file_(model.file()),
        placement_(read_placement(values)),
        blob_(sized(model)),
        options_(session_options_of(values)),
        setup_(setup::make_setup(options_, body())),
        faults_(read_faults(faults)) {
    // A refusal of the model or the configuration does not wait for the first tick.
    check(*make(resting(Eigen::Vector3d::Zero())));
  }

  /// Ends the run; the next tick begins another.
  void reset() {
    simulation_.reset();
    recorder_ = {};
  }

  Sample step_to(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity) {
    if (!simulation_) {
      begin(resting(position), std::nullopt);
    }
    simulation_->steer({position, velocity});
    return step();
  }

  Sample step_at(const Counts& counts) {
    if (!simulation_) {
      begin(resting(Eigen::Vector3d::Zero()), counts);
    }
    simulation_->hold_counts(counts);
    return step();
  }

  /// The next `ticks` ticks along a path, whose time 0 is now.
  void run(const simulation::HandPath& path, std::uint64_t ticks, ArrayTable& table) {
    if (!simulation_) {
      begin(path, std::nullopt);
    }
    const double begin_s = simulation_->time_s();
    std::vector<double> values;
    for (std::uint64_t i = 0; i < ticks; ++i) {
      if (i % kTicksPerBatch == kTicksPerBatch - 1) {
        check_signals();
      }
      simulation_->steer(path.at(simulation_->time_s() - begin_s));
      simulation::trace_values(step(), values);
      table.append(values);
    }
  }

  [[nodiscard]] simulation::HandPath script(const std::string& name, double seconds) const {
    setup::SessionOptions options = options_;
    options.script = name;
    options.seconds = seconds;
    return setup::hand_path(options, body());
  }

  [[nodiscard]] double rate_hz() const { return static_cast<double>(setup_.controller.rate_hz); }
  [[nodiscard]] double time_s() const { return simulation_ ? simulation_->time_s() : 0.0; }
  [[nodiscard]] const std::string& device() const { return options_.device; }
  [[nodiscard]] const char* state() const {
    return core::name_of(simulation_ ? simulation_->state() : core::State::kIdle);
  }
  [[nodiscard]] std::array<double, 3> origin_m() const {
    return widened(setup_.controller.model_origin_m);
  }
  [[nodiscard]] nlohmann::json summary() const { return setup::summary_json(recorder_.summary()); }
  /// Sends a command in the next tick; none before the first one.
  void post(core::Command command) {
    if (simulation_) {
      (void)simulation_->post(command);  // no option of a session makes its link watch only
    }
  }

 private:
  /// The model in the size of its placement.
  [[nodiscard]] std::shared_ptr<const support::BlobFile> sized(const Model& model) const {
    if (!placement_ || placement_->scale == 1.0) {
      return model.blob();
    }
    return setup::scaled_blob(*model.blob(), model.file(), placement_->scale).file;
  }
  [[nodiscard]] setup::FirstBody body() const {
    return {blob_->view(), placement_ ? placement_->pose : Eigen::Isometry3d::Identity(),
            placement_.has_value()};
  }
  [[nodiscard]] std::unique_ptr<simulation::Simulation> make(
      const simulation::HandPath& path) const {
    if (!placement_) {
      return std::make_unique<simulation::Simulation>(blob_->bytes(), setup_, path);
    }
    simulation::SceneBody placed;
    placed.blob = blob_->bytes();
    placed.path = simulation::BodyPath(placement_->pose);
    return std::make_unique<simulation::Simulation>(
        blob_->bytes(), setup_, path,
        std::make_unique<simulation::SceneTarget>(std::vector<simulation::SceneBody>{placed},
                                                  simulation::Simulation::arming_ticks(setup_)));
  }
  [[nodiscard]] static simulation::HandPath resting(const Eigen::Vector3d& position) {
    return simulation::HandPath(std::vector<simulation::Waypoint>{{0.0, position}});
  }
  void check(const simulation::Simulation& simulation) const {
    setup::check_start(file_, blob_->view(), setup_, simulation.start_result());
  }

  void begin(const simulation::HandPath& path, const std::optional<Counts>& counts) {
    auto fresh = make(path);
    check(*fresh);
    if (counts) {
      fresh->hold_counts(*counts);
    }
    if (!fresh->arm()) {
      setup::refuse_inactive(options_.device, setup_, *fresh);
    }
    fresh->inject(simulation::Injector(faults_));
    recorder_ = {};
    simulation_ = std::move(fresh);
  }

  Sample step() {
    const Sample sample = simulation_->step();
    recorder_.add(sample);
    return sample;
  }

  std::string file_;
  std::optional<simulation::Placement> placement_;
  std::shared_ptr<const support::BlobFile> blob_;  // in the size of the placement
  setup::SessionOptions options_;
  simulation::Setup setup_;
  std::vector<simulation::InjectedFault> faults_;
  std::unique_ptr<simulation::Simulation> simulation_;
  simulation::Recorder recorder_;
};

Eigen::Vector3d vector_of(const Doubles& array, const char* name) {
  const std::span<const double> values = rows_of(array, 3, name);
  if (values.size() != 3) {
    support::refuse(name, "is not one position", "give x, y and z");
  }
  return {values[0], values[1], values[2]};
}

std::uint64_t ticks_of(double ticks) {
  if (!(ticks >= 1.0 && ticks <= kMaxTicks)) {
    support::refuse("seconds",
                    fmt::format("{:.6g} ticks are outside 1 .. {:.0f}", ticks, kMaxTicks),
                    "choose another length of the run");
  }
  return static_cast<std::uint64_t>(ticks);
}

/// Rows x,y,z, one per tick, or rows t_s,x,y,z.
simulation::HandPath path_of(const Doubles& rows, double rate_hz) {
  const bool timed = rows.ndim() == 2 && rows.shape(1) == 4;
  const std::size_t width = timed ? 4 : 3;
  const std::span<const double> values = rows_of(rows, width, "path");
  std::vector<simulation::Waypoint> waypoints;
  for (std::size_t i = 0; i < values.size(); i += width) {
    const double t_s = timed ? values[i] : static_cast<double>(i / width) / rate_hz;
    const double* const p = values.data() + i + (timed ? 1 : 0);
    waypoints.push_back({t_s, {p[0], p[1], p[2]}});
  }
  return simulation::HandPath(std::move(waypoints));
}

py::array run_path(Session& session, const Doubles& rows, std::optional<double> seconds) {
  const simulation::HandPath path = path_of(rows, session.rate_hz());
  const bool timed = rows.ndim() == 2 && rows.shape(1) == 4;
  const double end_s = path.waypoints().back().t_s;
  const double own =
      timed ? std::round(end_s * session.rate_hz()) : static_cast<double>(path.waypoints().size());
  const std::uint64_t ticks = ticks_of(seconds ? std::round(*seconds * session.rate_hz()) : own);
  ArrayTable table(trace_fields());
  {
    const py::gil_scoped_release unlocked;
    session.run(path, ticks, table);
  }
  return std::move(table).to_array();
}

py::array run_script(Session& session, const std::string& script, double seconds) {
  const std::uint64_t ticks = ticks_of(std::round(seconds * session.rate_hz()));
  const simulation::HandPath path = session.script(script, seconds);
  ArrayTable table(trace_fields());
  {
    const py::gil_scoped_release unlocked;
    session.run(path, ticks, table);
  }
  return std::move(table).to_array();
}

py::array_t<double> vector(core::Vec3 v) { return triple(widened(v)); }

void add_tick(py::module_& module) {
  py::class_<Sample> tick(module, "Tick", "Outcome of a tick.");
  const auto property = [&tick](const char* name, auto get, const char* about) {
    tick.def_property_readonly(name, get, about);
  };
  property(
      "time_s", [](const Sample& s) { return s.t_s; }, "Time since the first tick, s.");
  property(
      "force_N", [](const Sample& s) { return vector(s.status.force); },
      "Force after the safety gate, N.");
  property(
      "position_m", [](const Sample& s) { return vector(s.status.probe); },
      "Position of the probe as the encoders see it, m.");
  property(
      "velocity_m_s", [](const Sample& s) { return vector(s.status.velocity); },
      "Velocity of the probe, m/s.");
  property(
      "tip_m",
      [](const Sample& s) {
        return triple({s.tip_m.x(), s.tip_m.y(), s.tip_m.z()});
      },
      "True position of the simulated device, m.");
  property(
      "proxy_m",
      [](const Sample& s) {
        const core::Rendering& r = s.status.rendering;
        return vector(r.in_contact ? r.proxy : s.status.probe);
      },
      "Position on the surface, m; that of the probe without contact.");
  property(
      "normal", [](const Sample& s) { return vector(s.status.rendering.normal); },
      "Normal of the surface; zero without contact.");
  property(
      "penetration_m", [](const Sample& s) { return s.status.rendering.penetration_m; },
      "Depth along the normal, m.");
  property(
      "in_contact", [](const Sample& s) { return s.status.rendering.in_contact; },
      "True if the probe touches the model.");
  property(
      "state", [](const Sample& s) { return core::name_of(s.status.state); },
      "State of the controller.");
  property(
      "faults", [](const Sample& s) { return s.status.faults; },
      "Bits of the latched faults, see tactree.fault_names().");
  property(
      "limits", [](const Sample& s) { return s.status.limits; },
      "Bits of the active limits, see tactree.limit_names().");
  tick.def("__repr__", [](const Sample& s) {
    const core::Vec3 f = s.status.force;
    return fmt::format("<tactree.Tick at {:.6g} s: {}, force ({:.4g}, {:.4g}, {:.4g}) N>", s.t_s,
                       core::name_of(s.status.state), f.x, f.y, f.z);
  });
}

}  // namespace

void add_simulation(py::module_& module) {
  add_tick(module);
  py::class_<Session> session(module, "Session");
  session.def(py::init<const Model&, const py::dict&, const std::vector<std::string>&>(),
              py::arg("model"), py::arg("options"), py::arg("faults"));
  session.def(
      "step_to",
      [](Session& s, const Doubles& position, const Doubles& velocity) {
        const Eigen::Vector3d p = vector_of(position, "hand_position");
        const Eigen::Vector3d v = vector_of(velocity, "hand_velocity");
        const py::gil_scoped_release unlocked;
        return s.step_to(p, v);
      },
      py::arg("position"), py::arg("velocity"), "A tick with this target of the hand.");
  session.def(
      "step_at",
      [](Session& s, const Doubles& counts) {
        const Eigen::Vector3d c = vector_of(counts, "encoders");
        const py::gil_scoped_release unlocked;
        return s.step_at({c.x(), c.y(), c.z()});
      },
      py::arg("counts"), "A tick with these counts of the encoders.");
  session.def("run_path", run_path, py::arg("path"), py::arg("seconds") = py::none(),
              "The ticks along a path.");
  session.def("run_script", run_script, py::arg("script"), py::arg("seconds"),
              "The ticks along a script.");
  session.def("reset", &Session::reset, "Ends the run.");
  session.def(
      "stop", [](Session& s) { s.post(core::Command::kStop); }, "Stops in the next tick.");
  session.def(
      "arm", [](Session& s) { s.post(core::Command::kArm); }, "Arms in the next tick.");
  session.def(
      "clear_faults", [](Session& s) { s.post(core::Command::kClearFault); },
      "Clears the faults in the next tick.");
  session.def(
      "summary", [](const Session& s) { return to_python(s.summary()); }, "The totals of the run.");
  session.def_property_readonly("rate_hz", &Session::rate_hz, "Ticks per second.");
  session.def_property_readonly("time_s", &Session::time_s, "Time of the next tick, s.");
  session.def_property_readonly("device", &Session::device, "Name or file of the device.");
  session.def_property_readonly("state", &Session::state, "State of the controller.");
  session.def_property_readonly(
      "origin_m", [](const Session& s) { return triple(s.origin_m()); },
      "Position of the model's origin in the device's frame, m.");
  module.def(
      "scripts", [] { return py::tuple(py::cast(simulation::script_names())); },
      "The motions of the hand.");
  module.def(
      "trace_dtype", [] { return dtype_of(trace_fields()); }, "The columns of a trace.");
}

}  // namespace tactree::python
