#pragma once
// Reports commands of a page that have no visible result: a fault that cannot be cleared because
// its cause persists, a controller that does not arm, an injected fault without a visible effect.

#include <optional>
#include <string>
#include <vector>

#include "tactree/core/control/controller.hpp"

namespace tactree::viewer {

/// Names of the faults, for example "encoder-invalid, supply".
[[nodiscard]] std::string names_of(core::FaultMask faults);

class CommandOutcome {
 public:
  void armed(double t_s) { arm_due_s_ = t_s + kArming_s; }
  void cleared(double t_s) { clear_due_s_ = t_s + kClearing_s; }
  /// Cancels all expected results.
  void stopped();
  /// `shows` states when the effect is visible, see simulation::shows_when().
  void injected(const std::string& fault, const std::string& shows, const core::Status& before,
                double t_s);
  void mended();

  /// Call it after each tick, with its result. Returns each report once.
  [[nodiscard]] std::optional<std::string> update(const core::Status& status, double t_s);

 private:
  // Time of the ticks after a command by which its result is visible.
  static constexpr double kArming_s = 0.3;
  static constexpr double kClearing_s = 0.1;
  static constexpr double kEffect_s = 1.0;

  struct Injection {
    std::string fault;
    std::string shows;
    core::Status before{};
    double due_s = 0.0;
  };
  [[nodiscard]] std::string remedy() const;
  [[nodiscard]] std::optional<std::string> not_cleared(const core::Status& status) const;
  [[nodiscard]] std::optional<std::string> not_armed(const core::Status& status) const;
  [[nodiscard]] std::optional<std::string> without_effect(const core::Status& status, double t_s);

  std::optional<double> arm_due_s_;
  std::optional<double> clear_due_s_;
  std::vector<Injection> watched_;
  std::vector<std::string> injected_;  // faults that have not been removed
};

}  // namespace tactree::viewer
