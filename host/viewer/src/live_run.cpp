#include "live_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactree/plant/vectors.hpp"

namespace tactree::viewer {
namespace {

// The dead-man control must be released for some ticks after arming.
constexpr double kHoldAfter_s = 0.08;
// Long against a tick, short against a hand that moves a slider.
constexpr double kChange_s = 0.1;

/// The height fades out before another wavelength moves the bumps, and then fades in.
float height_between(const core::ContactParameters& a, const core::ContactParameters& b,
                     float share) {
  if (a.texture_wavelength_m == b.texture_wavelength_m) {
    return std::lerp(a.texture_height_m, b.texture_height_m, share);
  }
  return share < 0.5F ? std::lerp(a.texture_height_m, 0.0F, 2.0F * share)
                      : std::lerp(0.0F, b.texture_height_m, 2.0F * share - 1.0F);
}

core::ContactParameters between(const core::ContactParameters& a, const core::ContactParameters& b,
                                float share) {
  return {std::lerp(a.stiffness_N_m, b.stiffness_N_m, share),
          std::lerp(a.damping_Ns_m, b.damping_Ns_m, share),
          std::lerp(a.static_friction, b.static_friction, share),
          std::lerp(a.dynamic_friction, b.dynamic_friction, share),
          height_between(a, b, share),
          share < 0.5F ? a.texture_wavelength_m : b.texture_wavelength_m};
}

}  // namespace

LiveRun::LiveRun(const Bodies& bodies, const simulation::Setup& setup, const Eigen::Vector3d& at_m,
                 std::uint64_t tick)
    : LiveRun(bodies, setup, at_m, tick,
              std::make_unique<simulation::SceneTarget>(bodies.bodies, 0)) {}

LiveRun::LiveRun(const Bodies& bodies, const simulation::Setup& setup, const Eigen::Vector3d& at_m,
                 std::uint64_t tick, std::unique_ptr<simulation::SceneTarget> target)
    : configuration_(setup.controller),
      target_(*target),
      sim_(bodies.bodies[0].blob, setup, simulation::HandPath({{0.0, at_m}}), std::move(target)) {
  target_.go_to(tick);
  sim_.go_to(tick);
  last_.t_s = sim_.time_s();
  last_.tip_m = at_m;
  last_.status.probe = plant::narrow(at_m);
}

// The page has no option by which its simulated application may only watch.
void LiveRun::post(core::Command command) { (void)sim_.post(command); }

void LiveRun::arm() {
  is_wanted_ = true;
  sim_.board().safety_inputs().hold_dead_man(false);
  post(core::Command::kArm);
  hold_at_s_ = sim_.time_s() + kHoldAfter_s;
}

void LiveRun::stop() {
  is_wanted_ = false;
  arms_after_change_ = false;
  sim_.board().safety_inputs().hold_dead_man(false);
  post(core::Command::kStop);
  hold_at_s_ = -1.0;
}

void LiveRun::clear() {
  post(core::Command::kClearFault);
  stop_next_ = true;
}

void LiveRun::inject(simulation::InjectedFault fault) {
  fault.from_s = sim_.time_s();
  sim_.injector().add(std::move(fault));
}

bool LiveRun::continue_from(const LiveRun& other) {
  sim_.inject(other.sim_.injector().on_other_board());
  const bool arms = other.is_wanted_ && other.sim_.state() != core::State::kFault;
  if (arms) {
    arm();
  }
  return arms;
}

bool LiveRun::change(const core::Configuration& wanted) {
  const core::Controller& controller = target_.controller();
  const core::Adjustment now = controller.adjustment();
  contact_before_ = now.contact;
  change_begin_s_ = sim_.time_s();
  configuration_ = wanted;
  is_changing_ = true;
  const bool must_stop = wanted.limits != now.limits || wanted.use_materials != now.use_materials;
  if (!must_stop || controller.motors_off()) {
    return false;
  }
  const bool arms_again = is_wanted_;
  stop();
  arms_after_change_ = arms_again;
  return arms_again;
}

core::ContactParameters LiveRun::next_contact() {
  const double share = (sim_.time_s() - change_begin_s_) / kChange_s;
  is_changing_ = share < 1.0;
  return between(contact_before_, configuration_.contact, static_cast<float>(std::min(share, 1.0)));
}

void LiveRun::adjust() {
  core::Adjustment wanted = target_.controller().adjustment();
  wanted.contact = next_contact();
  if (target_.controller().motors_off()) {
    wanted.limits = configuration_.limits;
    wanted.use_materials = configuration_.use_materials;
    if (std::exchange(arms_after_change_, false)) {
      arm();
    }
  }
  // Accepted: both ends of the change passed check(), whose limits are linear in the contact, and
  // the height of a texture is at most that of the end with this wavelength.
  (void)target_.adjust(sim_.board(), wanted);
}

void LiveRun::step(const plant::HandTarget& hand) {
  if (hold_at_s_ >= 0.0 && sim_.time_s() >= hold_at_s_) {
    sim_.board().safety_inputs().hold_dead_man(true);
    hold_at_s_ = -1.0;
  }
  if (is_changing_) {
    adjust();
  }
  sim_.steer(hand);
  last_ = sim_.step();
  strip_.add(last_.status);
  if (std::exchange(stop_next_, false)) {
    stop();  // the controller leaves the fault state only on a stop after the clear
  }
}

Eigen::Vector3d LiveRun::tip_m() const {
  return sim_.plant().position_m() - plant::widen(configuration_.model_origin_m);
}

}  // namespace tactree::viewer
