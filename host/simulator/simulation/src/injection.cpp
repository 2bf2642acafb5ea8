#include "tactree/simulation/injection.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "number_text.hpp"

namespace tactree::simulation {
namespace {

using hal::sim::EncoderFault;
using hal::sim::MotorFault;
using hal::sim::SimBoard;

enum class Takes { kNothing, kCounts, kEffort, kVolts, kDeadlines, kMillionths };

struct KindEntry {
  std::string_view part;
  std::string_view kind;
  InjectedKind injected;
  bool per_axis;
  Takes takes;
  std::string_view about;
  std::string_view shows;
};

constexpr std::array<KindEntry, 17> kKinds = {{
    {"encoder", "stuck", InjectedKind::kEncoderStuck, true, Takes::kNothing,
     "the count does not change", "it becomes visible when the axis moves while its motor pushes"},
    {"encoder", "disconnected", InjectedKind::kEncoderDisconnected, true, Takes::kNothing,
     "the reading is not valid", "it becomes visible while the device is homed"},
    {"encoder", "jump", InjectedKind::kEncoderJump, true, Takes::kCounts,
     "=COUNTS: permanent offset of the count",
     "it becomes visible as an offset of the probe; a larger offset is a fault (encoder-jump)"},
    {"motor", "dead", InjectedKind::kMotorDead, true, Takes::kNothing, "the motor gives no effort",
     "it becomes visible in contact, as a force in the wrong direction"},
    {"motor", "stuck", InjectedKind::kMotorStuck, true, Takes::kNothing,
     "the effort does not change", "it becomes visible when the force of a contact changes"},
    {"motor", "reversed", InjectedKind::kMotorReversed, true, Takes::kNothing,
     "the effort has the wrong sign",
     "it becomes visible in contact, as a force that pulls into the surface"},
    {"motor", "weak", InjectedKind::kMotorWeak, false, Takes::kEffort,
     "=EFFORT: saturation of all motors, N or Nm",
     "it becomes visible in contact, when the force needs more effort"},
    {"motor", "failure", InjectedKind::kMotorFailure, false, Takes::kNothing,
     "the amplifiers report a failure", "it becomes visible immediately"},
    {"estop", "pressed", InjectedKind::kEmergencyStop, false, Takes::kNothing,
     "the emergency stop is pressed", "it becomes visible immediately"},
    {"deadman", "released", InjectedKind::kDeadManReleased, false, Takes::kNothing,
     "the dead-man control is released", "it becomes visible while active"},
    {"enable", "off", InjectedKind::kEnableOff, false, Takes::kNothing,
     "the amplifiers lose their power", "it shows while armed"},
    {"enable", "on", InjectedKind::kEnableOn, false, Takes::kNothing,
     "the relay sticks: power independent of the line",
     "it becomes visible when the controller switches the power off (Stop)"},
    {"link", "dead", InjectedKind::kLinkDead, false, Takes::kNothing, "no message arrives",
     "this simulation requires no link; a board with --link-timeout reports link-lost"},
    {"link", "arm", InjectedKind::kLinkArm, false, Takes::kNothing,
     "every message is an arm command, as by duplication or an attack",
     "it becomes visible when the controller is not armed (Stop), as an unintended start"},
    {"supply", "sag", InjectedKind::kSupplySag, false, Takes::kVolts,
     "=VOLTS: supply of the amplifiers",
     "it becomes visible while armed, below the minimum supply voltage of the device"},
    {"loop", "overrun", InjectedKind::kLoopOverrun, false, Takes::kDeadlines,
     "=N: deadlines missed in one tick", "it becomes visible in the number of deadlines missed"},
    {"clock", "drift", InjectedKind::kClockDrift, false, Takes::kMillionths,
     "=PPM: excess of the board's second, ppm", "it is visible only in the times of a trace"},
}};

[[noreturn]] void refuse(std::string_view text, const std::string& what) {
  throw std::invalid_argument(
      fmt::format("'{}': {} (PART:KIND[=VALUE]@FROM[..TO], e.g. encoder1:stuck@2.5s)", text, what));
}

double seconds(std::string_view text, std::string_view time) {
  const std::optional<double> value = parse_seconds(time);
  if (!value) {
    refuse(text, fmt::format("the time '{}' is not a number", time));
  }
  if (*value < 0.0) {
    refuse(text, "the time is before arming");
  }
  return *value;
}

/// Cuts `rest` at the first `mark` and returns the text after it; empty without a mark.
std::string_view cut(std::string_view& rest, std::string_view mark) {
  const std::size_t at = rest.find(mark);
  if (at == std::string_view::npos) {
    return {};
  }
  const std::string_view after = rest.substr(at + mark.size());
  rest = rest.substr(0, at);
  return after;
}

std::string known_kinds(std::string_view part) {
  std::string list;
  for (const KindEntry& entry : kKinds) {
    if (part.empty() || entry.part == part) {
      list += fmt::format("{}{}:{}", list.empty() ? "" : ", ", entry.part, entry.kind);
    }
  }
  return list;
}

const KindEntry& find_kind(std::string_view text, std::string_view part, std::string_view kind) {
  const auto same_part = [&](const KindEntry& entry) { return entry.part == part; };
  if (std::none_of(kKinds.begin(), kKinds.end(), same_part)) {
    refuse(text, fmt::format("unknown part '{}'; one of {}", part, known_kinds("")));
  }
  const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const KindEntry& entry) {
    return entry.part == part && entry.kind == kind;
  });
  if (found == kKinds.end()) {
    refuse(text, fmt::format("{} has no kind '{}'; one of {}", part, kind, known_kinds(part)));
  }
  return *found;
}

double value_of(std::string_view text, const KindEntry& kind, std::string_view digits) {
  if (kind.takes == Takes::kNothing) {
    if (!digits.empty()) {
      refuse(text, fmt::format("{}:{} takes no value", kind.part, kind.kind));
    }
    return 0.0;
  }
  if (digits.empty()) {
    refuse(text, fmt::format("{}:{} needs a value: {}", kind.part, kind.kind, kind.about));
  }
  const std::optional<double> value = parse_number(digits);
  if (!value) {
    refuse(text, fmt::format("the value '{}' is not a number", digits));
  }
  const double low = kind.takes == Takes::kCounts || kind.takes == Takes::kMillionths ? -1e6 : 0.0;
  const double high = kind.takes == Takes::kDeadlines ? 1000.0 : 1e6;
  if (!(*value >= low && *value <= high)) {
    refuse(text, fmt::format("the value is outside {:g} .. {:g}", low, high));
  }
  return *value;
}

}  // namespace

std::vector<InjectionHelp> injection_kinds() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const KindEntry& entry : kKinds) {
      names.push_back(fmt::format("{}{}:{}", entry.part, entry.per_axis ? "N" : "", entry.kind));
    }
    return names;
  }();
  std::vector<InjectionHelp> help;
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    help.push_back({kNames[i], kKinds[i].about});
  }
  return help;
}

std::string_view shows_when(InjectedKind kind) {
  const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](const KindEntry& entry) { return entry.injected == kind; });
  return found == kKinds.end() ? std::string_view() : found->shows;
}

InjectedFault parse_injection(std::string_view text) {
  std::string_view part = text;
  std::string_view from = cut(part, "@");
  if (from.empty()) {
    refuse(text, "the time is missing");
  }
  const std::string_view until = cut(from, "..");
  std::string_view kind = cut(part, ":");
  const std::string_view digits = cut(kind, "=");
  InjectedFault fault;
  std::size_t letters = part.size();
  while (letters > 0 && part[letters - 1] >= '0' && part[letters - 1] <= '9') {
    --letters;
  }
  const std::string_view axis = part.substr(letters);
  const KindEntry& entry = find_kind(text, part.substr(0, letters), kind);
  if (!axis.empty() && (!entry.per_axis || axis < "1" || axis > "3" || axis.size() != 1)) {
    refuse(text, entry.per_axis ? "the axis is 1, 2 or 3"
                                : fmt::format("{}:{} takes no axis", entry.part, entry.kind));
  }
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    if (axis.empty() || axis[0] == static_cast<char>('1' + i)) {
      fault.axes.push_back(i);
    }
  }
  fault.kind = entry.injected;
  fault.value = value_of(text, entry, digits);
  fault.from_s = seconds(text, from);
  if (!until.empty()) {
    fault.until_s = seconds(text, until);
    if (!(fault.until_s > fault.from_s)) {
      refuse(text, "the end is before the start");
    }
  }
  return fault;
}

Injector::Injector(std::vector<InjectedFault> faults) {
  for (InjectedFault& fault : faults) {
    add(std::move(fault));
  }
}

Injector Injector::on_other_board() const {
  Injector other;
  for (const Entry& entry : entries_) {
    if (entry.fault.kind != InjectedKind::kEncoderJump &&
        entry.fault.kind != InjectedKind::kLoopOverrun) {
      other.add(entry.fault);
    }
  }
  return other;
}

void Injector::mend(double t_s) {
  for (Entry& entry : entries_) {
    entry.fault.until_s = std::min(entry.fault.until_s, t_s);
  }
}

void Injector::apply(SimBoard& board, double t_s) {
  for (Entry& entry : entries_) {
    const bool broken = t_s >= entry.fault.from_s && t_s < entry.fault.until_s;
    if (broken && !entry.broken) {
      begin(entry.fault, board);
    } else if (!broken && entry.broken) {
      end(entry.fault, board);
    }
    entry.broken = broken;
    if (broken) {
      keep(entry.fault, board);
    }
  }
}

double Injector::clock_ratio(double t_s) const {
  double ratio = 1.0;
  for (const Entry& entry : entries_) {
    const InjectedFault& fault = entry.fault;
    if (fault.kind == InjectedKind::kClockDrift && t_s >= fault.from_s && t_s < fault.until_s) {
      ratio *= 1.0 + 1e-6 * fault.value;
    }
  }
  return ratio;
}

void Injector::begin(const InjectedFault& fault, SimBoard& board) {
  const auto value = static_cast<std::int32_t>(std::lround(fault.value));
  for (const std::uint32_t axis : fault.axes) {
    switch (fault.kind) {
      case InjectedKind::kEncoderStuck:
        board.encoders().inject(axis, EncoderFault::kStuck);
        break;
      case InjectedKind::kEncoderDisconnected:
        board.encoders().inject(axis, EncoderFault::kDisconnected);
        break;
      case InjectedKind::kEncoderJump:
        board.encoders().jump(axis, value);
        break;
      case InjectedKind::kMotorDead:
        board.motors().inject(axis, MotorFault::kDead);
        break;
      case InjectedKind::kMotorStuck:
        board.motors().inject(axis, MotorFault::kStuck);
        break;
      case InjectedKind::kMotorReversed:
        board.motors().inject(axis, MotorFault::kReversed);
        break;
      default:
        break;
    }
  }
  if (fault.kind == InjectedKind::kEnableOff || fault.kind == InjectedKind::kEnableOn) {
    board.enable_line().stick(fault.kind == InjectedKind::kEnableOn);
  } else if (fault.kind == InjectedKind::kLoopOverrun) {
    board.ticker().miss(static_cast<std::uint32_t>(value));
  } else if (fault.kind == InjectedKind::kMotorFailure) {
    board.motors().set_healthy(false);
  } else if (fault.kind == InjectedKind::kMotorWeak) {
    board.motors().saturate(fault.value);
  } else if (fault.kind == InjectedKind::kSupplySag) {
    board.motors().set_supply(static_cast<float>(fault.value));
  } else if (fault.kind == InjectedKind::kEmergencyStop) {
    board.safety_inputs().press_emergency_stop(true);
  }
}

void Injector::end(const InjectedFault& fault, SimBoard& board) {
  const bool encoder =
      fault.kind == InjectedKind::kEncoderStuck || fault.kind == InjectedKind::kEncoderDisconnected;
  const bool motor = fault.kind == InjectedKind::kMotorDead ||
                     fault.kind == InjectedKind::kMotorStuck ||
                     fault.kind == InjectedKind::kMotorReversed;
  for (const std::uint32_t axis : fault.axes) {
    if (encoder) {
      board.encoders().inject(axis, EncoderFault::kNone);
    }
    if (motor) {
      board.motors().inject(axis, MotorFault::kNone);
    }
    if (fault.kind == InjectedKind::kEncoderJump) {
      board.encoders().jump(axis, -static_cast<std::int32_t>(std::lround(fault.value)));
    }
  }
  if (fault.kind == InjectedKind::kEnableOff || fault.kind == InjectedKind::kEnableOn) {
    board.enable_line().unstick();
  } else if (fault.kind == InjectedKind::kMotorFailure) {
    board.motors().set_healthy(true);
  } else if (fault.kind == InjectedKind::kMotorWeak) {
    board.motors().saturate_as_built();
  } else if (fault.kind == InjectedKind::kSupplySag) {
    board.motors().supply_as_built();
  } else if (fault.kind == InjectedKind::kEmergencyStop) {
    board.safety_inputs().press_emergency_stop(false);
  } else if (fault.kind == InjectedKind::kDeadManReleased) {
    board.safety_inputs().hold_dead_man(true);
  }
}

// Repeats the faults of the simulated user and application, who act in every tick.
void Injector::keep(const InjectedFault& fault, SimBoard& board) {
  if (fault.kind == InjectedKind::kDeadManReleased) {
    board.safety_inputs().hold_dead_man(false);
  } else if (fault.kind == InjectedKind::kLinkDead) {
    board.link().cut();
  } else if (fault.kind == InjectedKind::kLinkArm) {
    board.link().post(core::Command::kArm);
  }
}

}  // namespace tactree::simulation
