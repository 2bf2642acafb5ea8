#include "tactree/support/device_file.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tactree/support/json_reader.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKindNames[core::kDeviceKinds] = {"cartesian", "arm", "delta", "five-bar",
                                                        "paddle"};
constexpr const char* kHomingNames[core::kHomingMethods] = {"absolute", "given-pose", "index",
                                                            "hard-stop"};
constexpr std::uintmax_t kMaxBytes = 1U << 20U;

/// Visits the fields of a device's geometry with their keys and ranges, for reading and for
/// writing.
///   fields.one(key, value, low, high)    a number
///   fields.each(key, values, low, high)  one number for each of three axes
template <class Fields>
void visit_geometry(core::DeviceModel& m, Fields& fields) {
  switch (m.kind) {
    case core::DeviceKind::kCartesian:
      fields.each("counts_per_m", m.counts_per_m, 1.0, 1e9);
      return;
    case core::DeviceKind::kArm:
      fields.one("arm_m", m.arm.arm_m, 0.01, 10.0);
      fields.one("forearm_m", m.arm.forearm_m, 0.01, 10.0);
      fields.one("coupling", m.arm.coupling, 0.0, 1.0);
      break;
    case core::DeviceKind::kDelta:
      fields.one("a_m", m.delta.a, 1e-3, 1.0);
      fields.one("b_m", m.delta.b, 1e-3, 1.0);
      fields.one("c_m", m.delta.c, -1.0, 1.0);
      fields.one("d_m", m.delta.d, 0.0, 1.0);
      fields.one("e_m", m.delta.e, 0.0, 1.0);
      fields.one("f_m", m.delta.f, -1.0, 1.0);
      fields.one("r_m", m.delta.r, -1.0, 1.0);
      fields.one("s_m", m.delta.s, -1.0, 1.0);
      fields.each("leg_rad", m.delta.leg_rad, -6.2831853, 6.2831853);
      break;
    case core::DeviceKind::kFiveBar:
      fields.one("arm_m", m.five_bar.arm_m, 1e-3, 10.0);
      fields.one("forearm_m", m.five_bar.forearm_m, 1e-3, 10.0);
      fields.one("base_m", m.five_bar.base_m, 0.0, 10.0);
      break;
    case core::DeviceKind::kPaddle:
      fields.one("paddle_m", m.paddle_m, 1e-3, 10.0);
      break;
  }
  fields.each("counts_per_revolution", m.counts_per_revolution, 1.0, 1e7);
}

template <class Fields>
void visit_fields(core::DevicePreset& device, Fields& fields) {
  core::DeviceModel& m = device.model;
  const double furthest = m.kind == core::DeviceKind::kCartesian ? 1e12 : 100.0;
  visit_geometry(m, fields);
  fields.each("ratio", m.ratio, -1e5, 1e5);
  fields.each("home_position", m.home_position, -furthest, furthest);
  fields.each("joint_min", m.joint_min, -furthest, furthest);
  fields.each("joint_max", m.joint_max, -furthest, furthest);
  fields.each("joint_margin", m.joint_margin, 0.0, furthest);
  float origin[core::kAxes] = {m.origin_m.x, m.origin_m.y, m.origin_m.z};
  fields.each("origin_m", origin, -10.0, 10.0);
  m.origin_m = {origin[0], origin[1], origin[2]};
  fields.each("link_mass_kg", m.link_mass_kg, 0.0, 100.0);
  fields.each("link_centre_m", m.link_centre_m, -10.0, 10.0);
  fields.one("tip_mass_kg", m.tip_mass_kg, 0.0, 100.0);
  fields.each("torque_constant_Nm_per_ampere", m.torque_constant_Nm_per_ampere, 1e-6, 1e3);
  fields.one("force_max_N", device.drive.force_max_N, 0.01, 1e3);
  fields.each("effort_max", device.drive.effort_max, 1e-4, 1e3);
  fields.one("damping_Ns_m", device.drive.damping_Ns_m, 0.0, 1e3);
  fields.each("inertia", device.dynamics.inertia, 1e-9, 1e3);
  fields.each("viscous", device.dynamics.viscous, 0.0, 1e3);
  fields.each("coulomb", device.dynamics.coulomb, 0.0, 1e3);
}

/// The shortest decimal that is the same float: 0.2 instead of 0.20000000298.
double shortest(float value) { return std::stod(fmt::format("{}", value)); }

class Writer {
 public:
  explicit Writer(Json& json) : json_(json) {}
  void one(const char* key, const float& value, double, double) { json_[key] = shortest(value); }
  void each(const char* key, const float (&values)[core::kAxes], double, double) {
    json_[key] = {shortest(values[0]), shortest(values[1]), shortest(values[2])};
  }

 private:
  Json& json_;
};

constexpr JsonRemedies kRemedies = {
    "is unknown for this kind of device", "see --dump-device for the keys",
    "begin with a file of --dump-device", "one for each axis; 0 or 1 for an unused one"};

Json read_json(const std::string& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) {
    throw UserError(
        fmt::format("--device: '{}' is neither a device nor a readable file (devices: {}; or write "
                    "a file with --dump-device)",
                    file, listed(device_names())));
  }
  if (bytes > kMaxBytes) {
    throw UserError(fmt::format("{}: is too large for a device (at most 1 MiB)", file));
  }
  std::ifstream stream(file);
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object()) {
    throw UserError(
        fmt::format("{}: is not a JSON object (begin with a file of --dump-device)", file));
  }
  return json;
}

Device read_device(const std::string& file) {
  const Json json = read_json(file);
  JsonReader reader(file, json, kRemedies);
  Device device;
  device.name = reader.text("name");
  device.about = reader.text("about");
  core::DeviceModel& model = device.preset.model;
  model.kind = static_cast<core::DeviceKind>(reader.choice("kind", kKindNames));
  model.homing = static_cast<core::HomingMethod>(reader.choice("homing", kHomingNames));
  visit_fields(device.preset, reader);
  reader.finish();
  for (std::uint32_t i = 0; i < core::axes_of(model.kind); ++i) {
    const std::string axis = fmt::format("[{}]", i);
    if (!(model.joint_min[i] < model.joint_max[i])) {
      reader.refuse("joint_min" + axis, "is not below joint_max", "exchange them");
    }
    if (!(model.home_position[i] >= model.joint_min[i] &&
          model.home_position[i] <= model.joint_max[i])) {
      reader.refuse("home_position" + axis, "is outside the joint's range",
                    "between joint_min and joint_max");
    }
    if (!(model.joint_margin[i] <= 0.5F * (model.joint_max[i] - model.joint_min[i]))) {
      reader.refuse("joint_margin" + axis, "is more than half the joint's range", "lower it");
    }
    if (std::abs(model.ratio[i]) < 1e-3F) {
      reader.refuse("ratio" + axis, "is nearly 0", "at least 0.001, negative when reversed");
    }
  }
  if (!core::is_valid(model)) {
    reader.refuse("kind", "the values do not describe a device",
                  "begin with a file of --dump-device");
  }
  return device;
}

}  // namespace

std::vector<std::string> device_names() {
  std::vector<std::string> names;
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    names.emplace_back(preset.name);
  }
  return names;
}

Device load_device(const std::string& name_or_file) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    if (name_or_file == preset.name) {
      return {preset.name, preset.about, preset};
    }
  }
  return read_device(name_or_file);
}

std::string device_json(const Device& device) {
  Json json;
  json["name"] = device.name;
  json["about"] = device.about;
  json["kind"] = kKindNames[static_cast<std::size_t>(device.preset.model.kind)];
  json["homing"] = kHomingNames[static_cast<std::size_t>(device.preset.model.homing)];
  core::DevicePreset preset = device.preset;
  Writer writer(json);
  visit_fields(preset, writer);
  return json_text(json);
}

}  // namespace tactree::support
