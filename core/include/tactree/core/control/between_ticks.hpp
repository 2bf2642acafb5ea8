#pragma once
// Changes a controller between two ticks. The caller may be interrupted by the tick: each function
// holds the ticks during the change and passes an accepted change to the recorder, if present.
//
//   platform.hold_ticks(hold)  true: no tick starts; false: pending ticks run
//   platform.recorder()        optional: pointer to a recorder (hal/sim/session_recorder.hpp);
//                              nullptr: none
//
// A refused change has no effect and is not recorded. Call from the session's context only.
// Cost: that of the controller's function.

#include "tactree/core/control/controller.hpp"

namespace tactree::core {

/// Calls `report` with the recorder of a board or platform. Generates no code without one.
template <class Owner, class Report>
void report_to_recorder(Owner& owner, Report report) {
  if constexpr (requires { owner.recorder(); }) {
    if (owner.recorder() != nullptr) {
      report(*owner.recorder());
    }
  }
}

template <class Platform>
[[nodiscard]] ConfigurationStatus configure(Platform& platform, Controller& controller,
                                            const Configuration& configuration) {
  platform.hold_ticks(true);
  const ConfigurationStatus status = controller.configure(configuration);
  platform.hold_ticks(false);
  if (status == ConfigurationStatus::kOk) {
    report_to_recorder(platform, [&](auto& recorder) { recorder.configured(configuration); });
  }
  return status;
}

template <class Platform>
[[nodiscard]] ConfigurationStatus adjust(Platform& platform, Controller& controller,
                                         const Adjustment& adjustment) {
  platform.hold_ticks(true);
  const ConfigurationStatus status = controller.adjust(adjustment);
  platform.hold_ticks(false);
  if (status == ConfigurationStatus::kOk) {
    report_to_recorder(platform, [&](auto& recorder) { recorder.adjusted(adjustment); });
  }
  return status;
}

template <class Platform>
[[nodiscard]] ModelStatus load_model(Platform& platform, Controller& controller,
                                     const BlobView& view) {
  platform.hold_ticks(true);
  const ModelStatus status = controller.load_model(view);
  platform.hold_ticks(false);
  if (status == ModelStatus::kOk) {
    report_to_recorder(platform, [&](auto& recorder) { recorder.model_loaded(view); });
  }
  return status;
}

}  // namespace tactree::core
