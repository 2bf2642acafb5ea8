// Changes of a controller between two ticks.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/control/controller.hpp"

namespace tactree::core {

ConfigurationStatus Controller::configure(const Configuration& configuration) {
  if (!motors_off()) {
    return ConfigurationStatus::kBusy;
  }
  const ConfigurationStatus status = check(configuration);
  if (status != ConfigurationStatus::kOk) {
    return status;
  }
  if (!force_stage_.set_limits(configuration)) {
    return ConfigurationStatus::kBadLimit;
  }
  configuration_ = configuration;
  configured_ = true;
  monitor_.configure(configuration);
  sensor_.configure(configuration);
  force_stage_.configure_passivity(configuration);
  reset_scene();
  handle_event(Event::kConfigured);
  remove_unsuitable_bodies();
  return ConfigurationStatus::kOk;
}

Adjustment Controller::adjustment() const {
  const Configuration& c = configuration_;
  return {c.limits, c.link, c.use_materials, c.contact};
}

ConfigurationStatus Controller::adjust(const Adjustment& a) {
  Configuration c = configuration_;
  const bool limits =
      a.limits != c.limits || a.link != c.link || a.use_materials != c.use_materials;
  if (limits && !motors_off()) {
    return ConfigurationStatus::kBusy;
  }
  c.limits = a.limits;
  c.link = a.link;
  c.use_materials = a.use_materials;
  c.contact = a.contact;
  const ConfigurationStatus status = check(c);
  if (status != ConfigurationStatus::kOk) {
    return status;
  }
  configuration_ = c;
  force_stage_.allow_stored_energy();
  if (limits) {
    (void)force_stage_.set_limits(c);  // cannot fail: check() accepted the limits
    monitor_.set_link_timeout(c);
    remove_unsuitable_bodies();
  }
  return ConfigurationStatus::kOk;
}

void Controller::know_costs(const TickCosts& costs, std::uint32_t cycles_per_second) {
  admission_.know_costs(costs, cycles_per_second);
}

void Controller::remove_unsuitable_bodies() {
  TickLoad kept;
  for (std::uint32_t i = 0; i < kMaxBodies; ++i) {  // bound: kMaxBodies
    const BlobView view = scene_.view(i);
    if (view.empty()) {
      continue;
    }
    if (admission_.check(view, kept, configuration_) == ModelStatus::kOk) {
      kept.add(view.header(), configuration_);
    } else {
      (void)scene_.remove(i);
    }
  }
  notice_empty_scene();
  choose_work();
}

void Controller::choose_work() {
  const TickLoad load = load_of(scene_, configuration_);
  scene_.limit_work(load.bodies == 0U ? 0U : admission_.work_tier(load, configuration_));
}

ModelStatus Controller::may_change_models() const {
  if (!motors_off()) {
    return ModelStatus::kBusy;
  }
  return configured_ ? ModelStatus::kOk : ModelStatus::kNotConfigured;
}

ModelStatus Controller::load_model(const BlobView& view) {
  ModelStatus status = may_change_models();
  if (status == ModelStatus::kOk) {
    status = admission_.check(view, {}, configuration_);
  }
  if (status != ModelStatus::kOk) {
    return status;
  }
  scene_.clear();
  std::uint32_t number = 0;
  return add_body(view, {}, number);
}

ModelStatus Controller::add_body(const BlobView& view, const Pose& pose, std::uint32_t& number) {
  ModelStatus status = may_change_models();
  if (status == ModelStatus::kOk) {
    status = admission_.check(view, load_of(scene_, configuration_), configuration_);
  }
  if (status == ModelStatus::kOk) {
    status = scene_.add(view, pose, number);
  }
  if (status == ModelStatus::kOk) {
    choose_work();
    forget_motion();
    handle_event(Event::kModelLoaded);
  }
  return status;
}

ModelStatus Controller::remove_body(std::uint32_t number) {
  const ModelStatus status = scene_.remove(number);
  notice_empty_scene();
  return status;
}

ModelStatus Controller::unload_model() {
  if (!motors_off()) {
    return ModelStatus::kBusy;
  }
  scene_.clear();
  forget_motion();
  handle_event(Event::kModelRemoved);
  return ModelStatus::kOk;
}

}  // namespace tactree::core
