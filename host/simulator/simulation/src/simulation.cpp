#include "tactree/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {
namespace {

using plant::widen;

// The simulated user sends "arm", then holds the dead-man control.
constexpr std::uint64_t kArmAtTick = 2;
constexpr double kHoldAfterS = 0.08;
constexpr double kSettleS = 0.05;

hal::sim::BoardParameters with_rate(hal::sim::BoardParameters board, float rate_hz) {
  board.period_us = static_cast<std::uint32_t>(std::lround(1e6 / static_cast<double>(rate_hz)));
  board.rate_hz = rate_hz;
  return board;
}

/// The encoders of the board pass counts unchanged, because the device defines the scale.
hal::sim::BoardParameters counting(hal::sim::BoardParameters board, float rate_hz) {
  board = with_rate(board, rate_hz);
  board.encoders.counts_per_m = 1.0;
  return board;
}

// Counts of an axis in the home pose at power-up, if the device is not homed.
constexpr std::int32_t kCountsAtPowerUp = 1234;
// Speed at which the user moves from the home pose to the start of the path.
constexpr double kApproach_m_s = 0.1;

Setup with_homing(Setup setup) {
  setup.controller.device.homing =
      setup.homed ? core::HomingMethod::kAbsolute : core::HomingMethod::kGivenPose;
  return setup;
}

/// Position of the probe in the home pose, device frame.
Eigen::Vector3d home_of(const core::DeviceModel& device) {
  const float(&home)[core::kAxes] = device.home_position;
  return widen(core::locate_joints(device, {home[0], home[1], home[2]}).probe);
}

bool has_mass(const core::DeviceModel& model) {
  const auto heavy = [](float mass) { return mass > 0.0F; };
  return heavy(model.tip_mass_kg) ||
         std::any_of(std::begin(model.link_mass_kg), std::end(model.link_mass_kg), heavy);
}

plant::DevicePlantParameters mechanics(const Setup& setup) {
  plant::DevicePlantParameters p;
  p.model = setup.controller.device;
  p.hand = setup.plant.hand;
  p.substep_s = setup.plant.substep_s;
  p.has_weight = has_mass(p.model);
  const plant::DeviceParameters& same = setup.plant.device;
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    p.dynamics.inertia[i] = static_cast<float>(same.mass_kg);
    p.dynamics.viscous[i] = static_cast<float>(same.viscous_Ns_m);
    p.dynamics.coulomb[i] = static_cast<float>(same.coulomb_N);
  }
  p.dynamics = setup.dynamics.value_or(p.dynamics);
  return p;
}

}  // namespace

void use_device(const core::DevicePreset& device, Setup& setup) {
  core::use_device(device, setup.controller);
  setup.dynamics = device.dynamics;
  setup.board.motors.effort_max = static_cast<double>(
      *std::max_element(std::begin(device.drive.effort_max), std::end(device.drive.effort_max)));
}

Simulation::Simulation(std::span<const std::byte> blob, const Setup& setup, HandPath path,
                       std::unique_ptr<Target> target)
    : setup_(with_homing(setup)),
      path_(std::move(path)),
      at_home_m_(setup.homed ? std::nullopt : std::optional(home_of(setup.controller.device))),
      period_s_(1.0 / static_cast<double>(setup.controller.rate_hz)),
      board_(counting(setup.board, setup.controller.rate_hz), blob),
      target_(std::move(target)),
      start_(target_->start(board_, setup_.controller)),
      plant_(mechanics(setup), at_home_m_.value_or(path_.at(0.0).position_m +
                                                   widen(setup.controller.model_origin_m))) {
  // Fills the latency line with readings of the device at rest.
  for (std::uint32_t i = 0; i <= hal::sim::kMaxLatencyTicks; ++i) {
    sample_device();
  }
}

void Simulation::sample_device() {
  const core::DeviceModel& device = setup_.controller.device;
  double counts[core::kAxes] = {0.0, 0.0, 0.0};
  for (std::uint32_t i = 0; i < core::axes_of(device.kind); ++i) {
    const double displacement = plant_.joints()[i] - static_cast<double>(device.home_position[i]);
    counts[i] = displacement * static_cast<double>(core::counts_per_unit(device, i)) +
                static_cast<double>(device.home_count[i]) +
                (setup_.homed ? 0.0 : static_cast<double>(kCountsAtPowerUp));
    counts[i] = held_counts_ ? (*held_counts_)[i] : counts[i];
  }
  board_.sample(counts);
}

std::uint64_t Simulation::arming_ticks(const Setup& setup) {
  const double wait_s =
      kHoldAfterS + static_cast<double>(setup.controller.limits.ramp_s) + kSettleS;
  const double period_s = 1.0 / static_cast<double>(setup.controller.rate_hz);
  return static_cast<std::uint64_t>(std::ceil(wait_s / period_s));
}

bool Simulation::arm() {
  const double begin = path_.waypoints().front().t_s;
  const std::uint64_t ticks = arming_ticks(setup_);
  const auto hold_at = static_cast<std::uint64_t>(std::ceil(kHoldAfterS / period_s_));
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const bool dead_man = setup_.controller.supervision.dead_man_required;
    const bool arm_now = i == kArmAtTick || (!dead_man && i == hold_at);
    board_.link().post(arm_now ? core::Command::kArm : core::Command::kNone);
    board_.safety_inputs().hold_dead_man(i >= hold_at);
    tick(std::min(begin, 0.0));
  }
  return state_ == core::State::kActive;
}

bool Simulation::post(core::Command command) {
  if (!setup_.controller.link.may_command && command != core::Command::kStop) {
    return false;
  }
  command_ = command;
  return true;
}

Sample Simulation::step() { return step_with_hand_at(time_s()); }

Sample Simulation::step_with_hand_at(double path_t_s) {
  const double t_s = time_s();
  const core::Command command = std::exchange(command_, core::Command::kNone);
  // An application that may only watch sends no other messages than a stop.
  if (setup_.controller.link.may_command || command != core::Command::kNone) {
    board_.link().post(command);
  }
  injector_.apply(board_, t_s);
  Sample sample;
  sample.t_s = t_s;
  sample.tip_m = plant_.position_m() - widen(setup_.controller.model_origin_m);
  sample.button = board_.panel().is_pressed();
  sample.status = tick(path_t_s);
  sample.lamp = board_.panel().is_lit();
  if (held_counts_) {
    sample.tip_m = widen(sample.status.probe);
  }
  ++ticks_;
  return sample;
}

core::Status Simulation::tick(double path_t_s) {
  sample_device();
  const core::Status status = target_->tick(board_);
  state_ = status.state;
  if (held_counts_) {
    return status;
  }
  const bool is_homed = (status.limits & core::limit_bit(core::Limit::kNotHomed)) == 0U;
  const plant::HandTarget target = hand_at(path_t_s, is_homed);
  plant_.advance({board_.effort(0), board_.effort(1), board_.effort(2)}, target,
                 period_s_ * injector_.clock_ratio(time_s()));
  return status;
}

plant::HandTarget Simulation::hand_at(double path_t_s, bool is_homed) {
  plant::HandTarget target = steered_ ? *steered_ : path_.at(path_t_s);
  target.position_m += widen(setup_.controller.model_origin_m);
  if (!at_home_m_) {
    return target;
  }
  const Eigen::Vector3d way = target.position_m - *at_home_m_;
  const double step = is_homed ? kApproach_m_s * period_s_ : 0.0;
  if (way.norm() <= step) {
    at_home_m_.reset();
    return target;
  }
  *at_home_m_ += step / way.norm() * way;
  return {.position_m = *at_home_m_};
}

void Recorder::add(const Sample& sample) {
  const core::Status& status = sample.status;
  const core::Vec3 force = status.force;
  const float components[3] = {force.x, force.y, force.z};
  crc_.update(std::as_bytes(std::span(components)));

  const double step = first_ ? 0.0 : (widen(force) - widen(last_force_)).norm();
  summary_.force_max_N = std::max(summary_.force_max_N, widen(force).norm());
  summary_.force_step_max_N = std::max(summary_.force_step_max_N, step);
  if (status.rendering.in_contact) {
    ++summary_.contact_ticks;
    summary_.penetration_max_m =
        std::max(summary_.penetration_max_m, static_cast<double>(status.rendering.penetration_m));
  }
  add_reactions(status);
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    if (core::has_fault(status.faults & ~known_, fault)) {
      summary_.faults.push_back({fault, summary_.ticks});
    }
  }
  known_ = status.faults;
  last_force_ = force;
  first_ = false;
  summary_.overruns = status.overruns;
  ++summary_.ticks;
}

void Recorder::add_reactions(const core::Status& status) {
  const core::LimitMask crowded = core::limit_bit(core::Limit::kBodies);
  summary_.crowded_ticks += (status.limits & crowded) != 0U ? 1 : 0;
  for (const core::Reaction& reaction : status.reactions) {
    if (reaction.body < core::kMaxBodies) {
      BodySummary& body = summary_.bodies[reaction.body];
      ++body.contact_ticks;
      body.force_max_N = std::max(body.force_max_N, widen(reaction.force_N).norm());
      body.torque_max_Nm = std::max(body.torque_max_Nm, widen(reaction.torque_Nm).norm());
    }
  }
}

Summary Recorder::summary() const {
  Summary summary = summary_;
  summary.trace_crc32 = crc_.value();
  return summary;
}

}  // namespace tactree::simulation
