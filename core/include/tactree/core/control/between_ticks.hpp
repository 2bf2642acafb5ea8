#pragma once
// Changes of a running controller. Outside the loop, only the owner of a BetweenTicks changes the
// controller. Each change is made with the ticks held and recorded before they are released.
//
//   platform.hold_ticks(hold)  true: no tick starts; false: ticks that fell due run
//   platform.recorder()        optional: pointer to a recorder (hal/sim/session_recorder.hpp), or
//                              nullptr
//
// A refused change has no effect and is not recorded. Call from one context, never from the tick.
// Cost: that of the controller's function.

#include "tactree/core/control/controller.hpp"

namespace tactree::core {

/// Calls `report` with the recorder of a board or platform, if any. Generates no code if the type
/// has no recorder().
template <class Owner, class Report>
void report_to_recorder(Owner& owner, Report report) {
  if constexpr (requires { owner.recorder(); }) {
    if (owner.recorder() != nullptr) {
      report(*owner.recorder());
    }
  }
}

/// Platform of a context that no tick interrupts: a loop before its first tick, or a simulation in
/// one thread. `owner`: a board, with or without a recorder; kept by reference.
template <class Owner>
class Uninterrupted {
 public:
  explicit Uninterrupted(Owner& owner) : owner_(owner) {}
  void hold_ticks(bool /*hold*/) {}
  [[nodiscard]] auto* recorder() requires requires(Owner& owner) { owner.recorder(); }
  { return owner_.recorder(); }

 private:
  Owner& owner_;
};

template <class Platform>
class BetweenTicks {
 public:
  /// Both are kept by reference.
  BetweenTicks(Controller& controller, Platform& platform)
      : controller_(controller), platform_(platform) {}

  /// Does not hold the ticks: controller.hpp lists the functions that may be called during a tick.
  [[nodiscard]] const Controller& controller() const { return controller_; }

  /// Calls `read` with the controller while no tick changes it.
  template <class Read>
  auto read(Read read) {
    const Hold hold(platform_);
    return read(static_cast<const Controller&>(controller_));
  }

  [[nodiscard]] ConfigurationStatus configure(const Configuration& configuration) {
    return change([&] { return controller_.configure(configuration); },
                  [&](auto& recorder) { recorder.configured(configuration); });
  }
  [[nodiscard]] ConfigurationStatus adjust(const Adjustment& adjustment) {
    return change([&] { return controller_.adjust(adjustment); },
                  [&](auto& recorder) { recorder.adjusted(adjustment); });
  }
  [[nodiscard]] ModelStatus load_model(const BlobView& view) {
    return change([&] { return controller_.load_model(view); },
                  [&](auto& recorder) { recorder.model_loaded(view); });
  }
  [[nodiscard]] ModelStatus add_body(const BlobView& view, const Pose& pose,
                                     std::uint32_t& number) {
    return change([&] { return controller_.add_body(view, pose, number); },
                  [&](auto& recorder) { recorder.body_added(view, pose); });
  }
  [[nodiscard]] ModelStatus remove_body(std::uint32_t number) {
    return change([&] { return controller_.remove_body(number); },
                  [&](auto& recorder) { recorder.body_removed(number); });
  }
  [[nodiscard]] ModelStatus unload_model() {
    return change([&] { return controller_.unload_model(); },
                  [](auto& recorder) { recorder.model_unloaded(); });
  }

 private:
  /// Holds the ticks for its lifetime.
  class Hold {
   public:
    explicit Hold(Platform& platform) : platform_(platform) { platform_.hold_ticks(true); }
    ~Hold() { platform_.hold_ticks(false); }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    Platform& platform_;
  };

  template <class Change, class Report>
  auto change(Change change, Report report) {
    const Hold hold(platform_);
    const auto status = change();
    if (status == decltype(status)::kOk) {
      report_to_recorder(platform_, report);
    }
    return status;
  }

  Controller& controller_;
  Platform& platform_;
};

}  // namespace tactree::core
