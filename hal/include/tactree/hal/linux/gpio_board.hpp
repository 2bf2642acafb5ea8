#pragma once
// Parts of a board that are GPIO lines of a Linux computer. Each keeps the contract of board.hpp;
// constructors throw GpioError, nothing else does.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/quadrature.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/linux/gpio_lines.hpp"

namespace tactree::hal::linux_gpio {

struct EncoderLines {
  std::string a;
  std::string b;
  std::string index = {};  ///< high for a moment, once a revolution or at the home position
};

/// Quadrature by edges. Linux is no counter: edges that it missed, and transitions that cannot be,
/// are counted, and beyond a limit the axis is not valid any more, until the bank is made anew.
/// An index pulse counts where it rises, with the count of that moment: edges come in their order.
class GpioEncoderBank {
 public:
  /// One for each axis, at most core::kAxes; the other axes read 0. All on one chip.
  GpioEncoderBank(const std::vector<EncoderLines>& axes, const std::string& consumer,
                  std::uint32_t faults_max);

  [[nodiscard]] core::EncoderReading read() noexcept;

  [[nodiscard]] std::uint32_t illegal(std::uint32_t axis) const {
    return decoders_[axis].illegal();
  }
  /// Edges that the kernel had no room for, over all axes.
  [[nodiscard]] std::uint32_t lost() const { return lost_; }
  /// Of the newest edge; 0: none yet.
  [[nodiscard]] std::uint64_t last_edge_ns() const { return last_edge_ns_; }

 private:
  [[nodiscard]] static std::vector<std::string> names_of(const std::vector<EncoderLines>& axes);
  [[nodiscard]] static std::vector<std::uint32_t> axes_with_index(
      const std::vector<EncoderLines>& axes);
  void take(const Edge& edge, core::EncoderReading& reading) noexcept;
  [[nodiscard]] bool is_trusted(std::uint32_t axis) const;

  std::uint32_t axes_;
  std::vector<std::uint32_t> index_axes_;  // of the lines after all a and b
  std::uint32_t faults_max_;
  GpioLines lines_;
  std::array<core::QuadratureDecoder, core::kAxes> decoders_{};
  std::uint32_t next_sequence_ = 1;
  std::uint32_t lost_ = 0;
  std::uint64_t last_edge_ns_ = 0;
  bool gone_ = false;
};

/// Of amplifiers that report their failures on one line: high while there is none. A broken wire is
/// a failure. Where there is no such line (empty name) nobody complains.
class AmplifiersGood {
 public:
  AmplifiersGood(const std::string& line, const std::string& consumer);
  [[nodiscard]] bool read() const noexcept;

 private:
  std::optional<GpioLines> line_;
};

/// The line that gives the amplifiers their power, and the one that comes back from them. The
/// kernel lets go of the lines when the program ends, however it ends: then some drivers make the
/// line an input, so that the hardware's pull decides, and some leave it as it was. So let that
/// pull say off, and have an EnableGuard (enable_guard.hpp) that puts it off first.
///
/// Brakes that a spring closes are opened by a line of their own, of the same chip, together with
/// the power: they hold the device whenever the motors do not.
class GpioEnableLine {
 public:
  /// `brake`: high opens the brakes; empty: there are none.
  GpioEnableLine(const std::string& enable, const std::string& read_back,
                 const std::string& consumer, const std::string& brake = {});
  void set(bool on) noexcept { (void)enable_.set(on ? kAll : 0U); }
  [[nodiscard]] bool read_back() noexcept;
  /// The lines that set() drives, for a guard.
  [[nodiscard]] GpioLines& line() { return enable_; }
  ~GpioEnableLine() { set(false); }
  GpioEnableLine(const GpioEnableLine&) = delete;
  GpioEnableLine& operator=(const GpioEnableLine&) = delete;

 private:
  static constexpr std::uint64_t kAll = 3;  // enable, brake

  GpioLines enable_;
  GpioLines read_back_;
};

/// Emergency stop: a normally closed switch that pulls its line high while it is not pressed.
/// Dead-man: pulls its line high while it is held. A broken wire is the safe answer for both.
class GpioSafetyInputs {
 public:
  GpioSafetyInputs(const std::string& emergency_stop, const std::string& dead_man,
                   const std::string& consumer);
  /// Also when it was pressed for a moment since the last call.
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
