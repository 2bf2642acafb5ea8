#include "command_outcome.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "tactree/core/safety/faults.hpp"

namespace tactree::viewer {
namespace {

/// Returns true when the time is due, and then clears it.
bool is_due(std::optional<double>& due_s, double t_s) {
  if (!due_s || t_s < *due_s) {
    return false;
  }
  due_s.reset();
  return true;
}

// Limits are ignored, because a ramp or a contact changes them, too.
bool differs(const core::Status& a, const core::Status& b) {
  return a.state != b.state || a.faults != b.faults || a.overruns != b.overruns;
}

}  // namespace

std::string names_of(core::FaultMask faults) {
  std::vector<std::string> names;
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    if (core::has_fault(faults, fault)) {
      names.emplace_back(core::name_of(fault));
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void CommandOutcome::stopped() {
  arm_due_s_.reset();
  clear_due_s_.reset();
  watched_.clear();
}

void CommandOutcome::injected(const std::string& fault, const std::string& shows,
                              const core::Status& before, double t_s) {
  watched_.push_back({fault, shows, before, t_s + kEffect_s});
  if (std::find(injected_.begin(), injected_.end(), fault) == injected_.end()) {
    injected_.push_back(fault);
  }
}

void CommandOutcome::mended() {
  watched_.clear();
  injected_.clear();
}

std::optional<std::string> CommandOutcome::update(const core::Status& status, double t_s) {
  std::optional<std::string> report = without_effect(status, t_s);
  if (is_due(arm_due_s_, t_s)) {
    report = not_armed(status);
  }
  if (is_due(clear_due_s_, t_s)) {
    report = not_cleared(status);
  }
  return report;
}

std::string CommandOutcome::remedy() const {
  return injected_.empty() ? "Remove the cause (see Explanation), then use Clear."
                           : fmt::format("Injected: {}. Use Clear all injections, then Clear.",
                                         fmt::join(injected_, ", "));
}

std::optional<std::string> CommandOutcome::not_cleared(const core::Status& status) const {
  if (status.state != core::State::kFault) {
    return std::nullopt;
  }
  return fmt::format("Not cleared: the cause of {} persists. {}", names_of(status.faults),
                     remedy());
}

std::optional<std::string> CommandOutcome::not_armed(const core::Status& status) const {
  switch (status.state) {
    case core::State::kActive:
      return std::nullopt;
    case core::State::kFault:
      return fmt::format("Not armed: the fault {} is latched. {}", names_of(status.faults),
                         remedy());
    case core::State::kArmed:
      return (status.limits & core::limit_bit(core::Limit::kWaiting)) != 0U
                 ? "Armed, but not active yet: the probe is inside the object (bring the hand "
                   "back), or the amplifiers have no power."
                 : fmt::format("Armed, but not active yet: the dead-man control is not pressed. {}",
                               injected_.empty() ? "" : remedy());
    default:
      return fmt::format("Not armed: the controller is {}. {}", core::name_of(status.state),
                         injected_.empty() ? "" : remedy());
  }
}

std::optional<std::string> CommandOutcome::without_effect(const core::Status& status, double t_s) {
  std::optional<std::string> report;
  std::erase_if(watched_, [&](const Injection& one) {
    if (differs(one.before, status)) {
      return true;
    }
    if (t_s < one.due_s) {
      return false;
    }
    const bool is_off = status.state == core::State::kIdle;
    report = fmt::format("{} is injected, but has no visible effect yet: {}.{}", one.fault,
                         one.shows, is_off ? " The controller is idle; arm it first." : "");
    return true;
  });
  return report;
}

}  // namespace tactree::viewer
