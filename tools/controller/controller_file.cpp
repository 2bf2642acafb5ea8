#include "controller_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "tactree/support/explain.hpp"
#include "tactree/support/json_reader.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::controller {
namespace {

using support::JsonReader;

// Minimum time-out of the guard in ticks. A shorter time-out would treat one late tick as a dead
// loop.
constexpr std::uint64_t kGuardTicks = 5;
constexpr std::uint64_t kNsPerMs = 1'000'000;

/// Converts a path relative to the file's folder.
std::string from_folder(const std::filesystem::path& file, const std::string& path) {
  return (file.parent_path() / path).string();
}

std::string device_of(const std::filesystem::path& file, JsonReader& reader) {
  const std::string name = reader.text("device");
  const std::vector<std::string> known = support::device_names();
  return std::find(known.begin(), known.end(), name) != known.end() ? name
                                                                    : from_folder(file, name);
}

/// Keys that are missing leave their value unchanged.
void read_limits(JsonReader limits, core::Configuration& c) {
  const auto maybe = [&limits](const char* key, float& value, double low, double high) {
    if (limits.has(key)) {
      limits.one(key, value, low, high);
    }
  };
  const auto maybe_flag = [&limits](const char* key, bool& value) {
    value = limits.has(key) ? limits.flag(key) : value;
  };
  maybe("force_max_N", c.limits.force_max_N, 0.01, static_cast<double>(c.limits.force_max_N));
  maybe("slew_N_s", c.limits.slew_N_s, 1e-3, 1e6);
  maybe("ramp_s", c.limits.ramp_s, 1e-3, 10.0);
  maybe("speed_max_m_s", c.supervision.speed_max_m_s, 0.1, 100.0);
  maybe("stiffness_N_m", c.contact.stiffness_N_m, 0.0, 1e5);
  maybe("damping_Ns_m", c.contact.damping_Ns_m, 0.0, 1000.0);
  maybe("velocity_cutoff_hz", c.velocity_cutoff_hz, 1.0, 1e4);
  maybe("delay_s", c.delay_s, 0.0, 0.1);
  maybe("link_timeout_s", c.link.timeout_s, 0.005, 0.1);
  maybe("enable_timeout_s", c.supervision.enable_timeout_s, 1e-3, 1.0);
  maybe_flag("link_required", c.link.required);
  maybe_flag("dead_man_required", c.supervision.dead_man_required);
  maybe_flag("compensate_gravity", c.compensate_gravity);
  maybe_flag("use_materials", c.use_materials);
  limits.finish();
}

std::string maybe_text(JsonReader& reader, const char* key) {
  return reader.has(key) ? reader.text(key) : "";
}

/// Returns true if all axes have `key` and false if none has it; refuses a mixture.
bool are_of_kind(const std::vector<JsonReader>& axes, const char* key) {
  const bool first = axes.front().has(key);
  for (const JsonReader& axis : axes) {
    if (axis.has(key) != first) {
      axis.refuse(key, "is given for some axes only", "connect all axes in the same way");
    }
  }
  return first;
}

void read_counters(std::vector<JsonReader>& axes, hal::linux_gpio::CounterSettings& counters) {
  for (JsonReader& axis : axes) {
    counters.axes.push_back({axis.text("counter"), axis.whole("count", 0, 1000)});
    axis.finish();
  }
}

void read_encoders(JsonReader encoders, const core::DeviceModel& device,
                   hal::linux_gpio::ControllerBoardSettings& board) {
  const std::size_t count = core::axes_of(device.kind);
  std::vector<JsonReader> axes = encoders.objects("axes", count, count);
  const bool at_index = device.homing == core::HomingMethod::kIndex;
  if (are_of_kind(axes, "counter")) {
    if (at_index) {
      encoders.refuse("axes", "counters report no index pulse, which homing of this device needs",
                      "wire the encoders to lines, or give the device another homing");
    }
    if (encoders.has("counter_root")) {
      board.counters.root = encoders.text("counter_root");
    }
    read_counters(axes, board.counters);
    encoders.finish();
    return;
  }
  if (encoders.has("faults_max")) {
    board.encoder_faults_max = encoders.whole("faults_max", 0, 1'000'000);
  }
  for (JsonReader& axis : axes) {
    board.encoders.push_back({axis.text("a"), axis.text("b"),
                              at_index ? axis.text("index") : maybe_text(axis, "index")});
    axis.finish();
  }
  encoders.finish();
}

void read_pwm(JsonReader& motors, std::vector<JsonReader>& axes,
              hal::linux_gpio::MotorSettings& settings) {
  if (motors.has("pwm_root")) {
    settings.pwm_root = motors.text("pwm_root");
  }
  settings.period_ns = motors.whole("period_ns", 1000, 1'000'000'000);
  settings.good = maybe_text(motors, "good");
  for (JsonReader& axis : axes) {
    hal::linux_gpio::MotorLines lines;
    lines.chip = axis.text("chip");
    lines.channel = axis.whole("channel", 0, 1000);
    lines.direction = axis.text("direction");
    axis.one("effort_at_full_width", lines.effort_at_full_width, 1e-4, 1e3);
    axis.finish();
    settings.axes.push_back(std::move(lines));
  }
}

void read_converters(JsonReader& motors, std::vector<JsonReader>& axes,
                     hal::linux_gpio::ConverterSettings& settings) {
  constexpr std::uint32_t kCodeMax = 0xFFFFFF;  // 24 bits, the finest resolution available
  if (motors.has("converter_root")) {
    settings.root = motors.text("converter_root");
  }
  settings.good = maybe_text(motors, "good");
  for (JsonReader& axis : axes) {
    hal::linux_gpio::ConverterAxis output;
    output.device = axis.text("converter");
    output.channel = axis.whole("channel", 0, 1000);
    output.zero_code = static_cast<std::int32_t>(axis.whole("zero_code", 0, kCodeMax));
    output.full_code = static_cast<std::int32_t>(axis.whole("full_code", 0, kCodeMax));
    if (2 * output.zero_code < output.full_code) {
      axis.refuse("zero_code", "leaves no range for efforts of the opposite sign",
                  "give at least half of full_code");
    }
    if (output.zero_code == output.full_code) {
      axis.refuse("full_code", "equals zero_code, which gives no effort", "give another value");
    }
    axis.one("effort_at_full", output.effort_at_full, 1e-4, 1e3);
    axis.finish();
    settings.axes.push_back(std::move(output));
  }
}

void read_motors(JsonReader motors, std::size_t count,
                 hal::linux_gpio::ControllerBoardSettings& board) {
  std::vector<JsonReader> axes = motors.objects("axes", count, count);
  if (are_of_kind(axes, "converter")) {
    read_converters(motors, axes, board.converters);
  } else {
    read_pwm(motors, axes, board.motors);
  }
  motors.finish();
}

void read_lines(JsonReader lines, hal::linux_gpio::ControllerBoardSettings& board) {
  board.enable = lines.text("enable");
  board.enable_read_back = lines.text("enable_read_back");
  board.emergency_stop = lines.text("emergency_stop");
  board.dead_man = lines.text("dead_man");
  board.brake = maybe_text(lines, "brake");
  board.heartbeat = maybe_text(lines, "heartbeat");
  lines.finish();
}

void read_watchdog(JsonReader watchdog, hal::linux_gpio::ControllerBoardSettings& board) {
  board.watchdog = watchdog.text("device");
  board.watchdog_timeout_s = watchdog.whole("timeout_s", 1, 600);
  watchdog.finish();
}

void read_real_time(JsonReader reader, ControllerFile& result) {
  if (reader.has("priority")) {
    result.real_time.priority = static_cast<int>(reader.whole("priority", 0, 98));
  }
  if (reader.has("required")) {
    result.real_time.required = reader.flag("required");
  }
  if (reader.has("guard_ms")) {
    result.board.guard.silence_ns = kNsPerMs * reader.whole("guard_ms", 1, 1000);
    const std::uint64_t least = kGuardTicks * result.board.period_ns;
    if (result.board.guard.silence_ns < least) {
      reader.refuse("guard_ms", "is shorter than five ticks",
                    fmt::format("give {} or more", (least + kNsPerMs - 1) / kNsPerMs));
    }
  }
  reader.finish();
}

/// Checks that involve several values.
void check_together(const JsonReader& reader, const core::Configuration& configuration) {
  const core::ConfigurationStatus status = core::check(configuration);
  if (status == core::ConfigurationStatus::kUnstable) {
    reader.refuse("limits.stiffness_N_m",
                  fmt::format("{:.6g} N/m is beyond the stability limit of {:.6g} N/m with a hand",
                              configuration.contact.stiffness_N_m,
                              core::stability_limit(configuration).with_hand_N_m),
                  "lower it, or raise rate_hz or damping_Ns_m");
  }
  if (status != core::ConfigurationStatus::kOk) {
    reader.refuse("limits", support::explain(core::refusal_of(configuration)),
                  "give a value in that range");
  }
}

core::Configuration begin_configuration(JsonReader& reader, const support::Device& device) {
  core::Configuration configuration;
  core::use_device(device.preset, configuration);
  reader.one("rate_hz", configuration.rate_hz, 100.0, 20000.0);
  core::limit_to_rate(configuration);
  if (reader.has("model_origin_m")) {
    float origin[core::kAxes] = {0.0F, 0.0F, 0.0F};
    reader.each("model_origin_m", origin, -10.0, 10.0);
    configuration.model_origin_m = {origin[0], origin[1], origin[2]};
  }
  return configuration;
}

// Limits the efforts to those that the motors can produce.
void bound_efforts(const hal::linux_gpio::ControllerBoardSettings& board, core::Configuration& c) {
  for (std::size_t i = 0; i < board.motors.axes.size(); ++i) {
    c.motors.effort_max[i] =
        std::min(c.motors.effort_max[i], board.motors.axes[i].effort_at_full_width);
  }
  for (std::size_t i = 0; i < board.converters.axes.size(); ++i) {
    c.motors.effort_max[i] =
        std::min(c.motors.effort_max[i], board.converters.axes[i].effort_at_full);
  }
}

/// Reduces default slew rates whose change per tick exceeds the range of the safety gate, which may
/// happen at a low rate. A slew rate in the file is kept, and is refused later if it is out of
/// range.
void fit_slews(bool given, core::Configuration& c) {
  constexpr float kShareOfATick = 1.0F;  // change per tick / limit; the gate accepts up to 2
  if (!given) {
    c.limits.slew_N_s =
        std::min(c.limits.slew_N_s, kShareOfATick * c.limits.force_max_N * c.rate_hz);
  }
  for (std::size_t i = 0; i < core::kAxes; ++i) {
    c.motors.effort_slew_s[i] =
        std::min(c.motors.effort_slew_s[i], kShareOfATick * c.motors.effort_max[i] * c.rate_hz);
  }
}

LinkSettings read_link(JsonReader& reader) {
  LinkSettings link;
  if (reader.has("socket") == reader.has("usb")) {
    reader.refuse("socket", "exactly one of socket and usb is required",
                  "give socket for programs on this board, or usb for its USB device port");
  }
  if (reader.has("socket")) {
    link.socket = reader.text("socket");
    return link;
  }
  JsonReader usb = reader.object("usb");
  link.usb_port = maybe_text(usb, "port");
  link.usb_serial = usb.has("serial") ? usb.whole("serial", 0, 0xFFFFFFFF) : 0U;
  usb.finish();
  return link;
}

}  // namespace

ControllerFile read_controller_file(const std::filesystem::path& file) {
  const JsonReader::Json json = support::read_json(file);
  JsonReader reader(file.string(), json, "docs/LINUX-BOARD.md");
  if (reader.has("about")) {
    (void)reader.text("about");
  }
  ControllerFile result;
  result.file = file.string();
  result.device = support::load_device(device_of(file, reader));
  result.model = from_folder(file, reader.text("model"));
  result.configuration = begin_configuration(reader, result.device);
  const double period_ns = 1e9 / static_cast<double>(result.configuration.rate_hz);
  result.board.period_ns = static_cast<std::uint64_t>(std::llround(period_ns));
  result.board.guard.silence_ns = std::max(10 * kNsPerMs, kGuardTicks * result.board.period_ns);
  bool slew_given = false;
  if (reader.has("limits")) {
    JsonReader limits = reader.object("limits");
    slew_given = limits.has("slew_N_s");
    read_limits(std::move(limits), result.configuration);
  }
  const bool first_force = reader.has("first_force") && reader.flag("first_force");
  const core::DeviceModel& device = result.device.preset.model;
  read_encoders(reader.object("encoders"), device, result.board);
  read_motors(reader.object("motors"), core::axes_of(device.kind), result.board);
  bound_efforts(result.board, result.configuration);
  fit_slews(slew_given, result.configuration);
  read_lines(reader.object("lines"), result.board);
  if (reader.has("watchdog")) {
    read_watchdog(reader.object("watchdog"), result.board);
  }
  if (reader.has("real_time")) {
    read_real_time(reader.object("real_time"), result);
  }
  result.link = read_link(reader);
  reader.finish();
  result.board.guard.priority = result.real_time.priority == 0 ? 0 : result.real_time.priority + 1;
  check_together(reader, result.configuration);
  if (first_force) {
    result.configuration = core::first_force(result.configuration);
  }
  return result;
}

}  // namespace tactree::controller
