#pragma once
// Faults on purpose: what breaks, how, and when. A script of one is PART:KIND[=VALUE]@FROM[..TO],
// times in seconds after arming:
//
//   encoder1:stuck@2.5s            axis 1 to 3; without a number all axes
//   encoder2:jump=500@1s           counts
//   motor3:reversed@1s..1.2s       mended after 0.2 s
//   supply:sag=12@3s               V
//   loop:overrun=2@1s              deadlines missed in that tick
//   clock:drift=20000@0s           millionths that the board's second is longer than a second

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactree/core/controller.hpp"
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

/// A line of help: part, kind, what it does.
struct InjectionHelp {
  std::string_view name;
  std::string_view about;
};
[[nodiscard]] std::vector<InjectionHelp> injection_kinds();

/// Throws std::invalid_argument that quotes `text`, says what is wrong and what may be there.
[[nodiscard]] InjectedFault parse_injection(std::string_view text);

/// Breaks and mends the parts of a simulated board in time.
class Injector {
 public:
  Injector() = default;
  explicit Injector(std::vector<InjectedFault> faults);

  void add(InjectedFault fault) { entries_.push_back({std::move(fault), false}); }
  /// Ends at `t_s` what would go on beyond it.
  void mend(double t_s);

  /// Before the loop's tick at `t_s`, after the link's message was posted.
  void apply(hal::sim::SimBoard& board, double t_s);
  /// Seconds that pass for the device while the board believes one passes.
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
