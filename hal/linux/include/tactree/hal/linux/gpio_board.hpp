#pragma once
// Components of a board on GPIO lines of a Linux computer. Each satisfies its concept in board.hpp.
// Only constructors throw: GpioError.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/device/quadrature.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/gpio_lines.hpp"
#include "tactree/hal/linux/level_watch.hpp"

namespace tactree::hal::linux_gpio {

struct EncoderLines {
  std::string a;
  std::string b;
  std::string index = {};  ///< index pulse, once per revolution or at the home position
};

/// Decodes quadrature signals from edges. Counts lost edges and illegal transitions; above a limit
/// the axis stays invalid until the bank is constructed again. Edges count as lost if GpioLines
/// reports them, if an edge repeats the level of its line, or if the level of a line has differed
/// from the decoded one for 2 ms. Edges that the chip merged in pairs on both lines of an axis are
/// not detected; this requires edges that are closer than the time to handle an interrupt. The
/// rising edge of an index pulse latches the count. For one thread.
class GpioEncoderBank {
 public:
  /// One element per axis, at most core::kAxes; other axes read 0. All lines must be on one chip.
  GpioEncoderBank(const std::vector<EncoderLines>& axes, const std::string& consumer,
                  std::uint32_t faults_max);

  /// Processes the edges since the last call. Cost: at most 64 calls of GpioLines::read_edges(),
  /// that is 4096 edges, and one call of GpioLines::levels().
  [[nodiscard]] core::EncoderReading read() noexcept;

  /// Illegal transitions of an axis. Precondition: axis < core::kAxes.
  [[nodiscard]] std::uint32_t illegal(std::uint32_t axis) const {
    return decoders_[axis].illegal();
  }
  /// Number of edges of all axes that are known to be lost.
  [[nodiscard]] std::uint32_t lost() const { return lines_.lost() + unseen_; }

 private:
  [[nodiscard]] static std::vector<std::string> names_of(const std::vector<EncoderLines>& axes);
  [[nodiscard]] static std::vector<std::uint32_t> axes_with_index(
      const std::vector<EncoderLines>& axes);
  void take(const Edge& edge, core::EncoderReading& reading) noexcept;
  void compare_levels() noexcept;
  [[nodiscard]] bool is_trusted(std::uint32_t axis) const;

  std::uint32_t axes_;
  std::vector<std::uint32_t> index_axes_;  // axis of each index line, after all lines a and b
  std::uint32_t faults_max_;
  GpioLines lines_;
  std::array<core::QuadratureDecoder, core::kAxes> decoders_{};
  std::uint64_t decoded_ = 0;  // levels after the processed edges, one bit per line
  LevelWatch watch_;
  std::uint32_t unseen_ = 0;  // lost edges that GpioLines does not report
  bool gone_ = false;
};

/// Failure line of the amplifiers: high while there is no failure. A broken wire reads as a
/// failure. With an empty name there is no line, and no failure is reported.
class AmplifiersGood {
 public:
  AmplifiersGood(const std::string& line, const std::string& consumer);
  [[nodiscard]] bool read() const noexcept;

 private:
  std::optional<GpioLines> line_;
};

/// The line that switches the power of the amplifiers, and its read-back. The kernel releases the
/// lines when the program ends: some drivers then make the line an input, others keep its level.
/// Pull the line down in hardware and use an EnableGuard (enable_guard.hpp), which switches it off.
///
/// Spring-applied brakes have a separate line on the same chip, which releases them together with
/// the power. They hold the device while the motors are off.
class GpioEnableLine {
 public:
  /// `brake`: line that releases the brakes while high; empty: none.
  GpioEnableLine(const std::string& enable, const std::string& read_back,
                 const std::string& consumer, const std::string& brake = {});
  void set(bool on) noexcept { (void)enable_.set(on ? kAll : 0U); }
  [[nodiscard]] bool read_back() noexcept;
  /// The lines driven by set(), for a guard.
  [[nodiscard]] GpioLines& line() { return enable_; }
  ~GpioEnableLine() { set(false); }
  GpioEnableLine(const GpioEnableLine&) = delete;
  GpioEnableLine& operator=(const GpioEnableLine&) = delete;

 private:
  static constexpr std::uint64_t kAll = 3;  // bits of enable and brake

  GpioLines enable_;
  GpioLines read_back_;
};

/// Emergency stop: a normally closed switch, line high while not pressed. Dead-man control: line
/// high while held. A broken wire of either reads as the safe state.
class GpioSafetyInputs {
 public:
  GpioSafetyInputs(const std::string& emergency_stop, const std::string& dead_man,
                   const std::string& consumer);
  /// Also returns true if it was pressed or released since the last call, however briefly.
  [[nodiscard]] bool emergency_stop() noexcept;
  [[nodiscard]] bool dead_man() noexcept;

 private:
  GpioLines emergency_stop_;
  GpioLines dead_man_;
};

static_assert(EncoderBank<GpioEncoderBank>);
static_assert(EnableLine<GpioEnableLine>);
static_assert(SafetyInputs<GpioSafetyInputs>);

}  // namespace tactree::hal::linux_gpio
