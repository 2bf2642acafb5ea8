#pragma once
// Fault injection. A fault has a component, a kind and a time. Syntax:
// PART:KIND[=VALUE]@FROM[..TO], times in seconds after arming:
//
//   encoder1:stuck@2.5s            axis 1 to 3; all axes without a number
//   encoder2:jump=500@1s           counts
//   motor3:reversed@1s..1.2s       ends after 0.2 s
//   supply:sag=12@3s               V
//   loop:overrun=2@1s              deadlines missed in the tick at 1 s
//   clock:drift=20000@0s           ppm by which a second of the board's clock is too long

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/sim/board.hpp"

namespace tactree::simulation {

enum class InjectedKind {
  kEncoderStuck,
  kEncoderDisconnected,
  kEncoderJump,
  kMotorDead,
  kMotorStuck,
  kMotorReversed,
  kMotorWeak,
  kMotorFailure,
  kEmergencyStop,
  kDeadManReleased,
  kEnableOff,
  kEnableOn,
  kLinkDead,
  kLinkArm,
  kSupplySag,
  kLoopOverrun,
  kClockDrift,
};

struct InjectedFault {
  InjectedKind kind = InjectedKind::kEncoderStuck;
  std::vector<std::uint32_t> axes;  ///< of an encoder or motor
  double value = 0.0;
  double from_s = 0.0;
  double until_s = std::numeric_limits<double>::infinity();
};

/// One line of help: part and kind, effect.
struct InjectionHelp {
  std::string_view name;
  std::string_view about;
};
[[nodiscard]] std::vector<InjectionHelp> injection_kinds();

/// Clause that states when the effect of such a fault is visible in a session, for example "it
/// shows in contact".
[[nodiscard]] std::string_view shows_when(InjectedKind kind);

/// Throws std::invalid_argument with `text`, the cause and the accepted values.
[[nodiscard]] InjectedFault parse_injection(std::string_view text);

/// Starts and ends the faults of a simulated board at their times.
class Injector {
 public:
  Injector() = default;
  explicit Injector(std::vector<InjectedFault> faults);

  void add(InjectedFault fault) { entries_.push_back({std::move(fault), false}); }
  /// The lasting faults, for a board that has none of them yet.
  [[nodiscard]] Injector on_other_board() const;
  /// Ends all faults at `t_s` at the latest.
  void mend(double t_s);

  /// Call it before the loop's tick at `t_s`, after the link's message has been posted.
  void apply(hal::sim::SimBoard& board, double t_s);
  /// Real seconds per second of the board's clock.
  [[nodiscard]] double clock_ratio(double t_s) const;

 private:
  struct Entry {
    InjectedFault fault;
    bool broken = false;
  };
  static void begin(const InjectedFault& fault, hal::sim::SimBoard& board);
  static void end(const InjectedFault& fault, hal::sim::SimBoard& board);
  static void keep(const InjectedFault& fault, hal::sim::SimBoard& board);

  std::vector<Entry> entries_;
};

}  // namespace tactree::simulation
