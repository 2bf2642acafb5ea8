#pragma once
// Interface of a board, as concepts. A port implements these types, combines them in one board type
// and runs conformance.hpp on it.
//
// All functions except Ticker::wait() return immediately. They never throw or allocate, report
// errors only by return values, and are called only from the context of the control loop.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "tactree/core/control/controller.hpp"

namespace tactree::hal {

/// Position counters of the axes.
///   read()  returns the current counts, latched at one instant; they wrap at 2^32. An axis with an
///           unreliable counter (broken wire, lost index) is not valid; its count is ignored.
template <class T>
concept EncoderBank = requires(T& bank) {
  { bank.read() }
  noexcept->std::same_as<core::EncoderReading>;
};

/// Amplifiers and motors.
///   write(command)  sets the efforts until the next write, N or Nm per axis. The effort is zero
///                   before the first write and while the enable line is off.
///   healthy()       returns false if an amplifier reports a failure, or if a command was not
///                   delivered.
/// A bank that measures its supply also has, for Configuration::supply_monitored:
///   supply_V()      returns the supply voltage, a float.
template <class T>
concept MotorBank = requires(T& bank, const core::MotorCommand& command) {
  { bank.write(command) }
  noexcept->std::same_as<void>;
  { bank.healthy() }
  noexcept->std::same_as<bool>;
};

/// Line that enables the power of the amplifiers. It is off after reset.
///   set(on)      sets the line.
///   read_back()  returns the state measured at the amplifiers, not the value last set. It follows
///                set() within Configuration::enable_timeout_s.
template <class T>
concept EnableLine = requires(T& line, bool on) {
  { line.set(on) }
  noexcept->std::same_as<void>;
  { line.read_back() }
  noexcept->std::same_as<bool>;
};

/// Safety switches of the user.
///   emergency_stop()  returns true while pressed. A broken wire reads as pressed.
///   dead_man()        returns true while held. A broken wire reads as released.
template <class T>
concept SafetyInputs = requires(T& inputs) {
  { inputs.emergency_stop() }
  noexcept->std::same_as<bool>;
  { inputs.dead_man() }
  noexcept->std::same_as<bool>;
};

/// Result of Ticker::wait().
struct Tick {
  std::uint32_t overruns = 0;  ///< deadlines missed since the last wait; 0: on time
};

/// Tick source of the loop, and a clock.
///   wait()    returns at the next tick, or immediately if the tick has passed; this counts as an
///             overrun.
///   now_us()  returns the time, us; monotonic, wraps at 2^32.
template <class T>
concept Ticker = requires(T& ticker) {
  { ticker.wait() }
  noexcept->std::same_as<Tick>;
  { ticker.now_us() }
  noexcept->std::same_as<std::uint32_t>;
};

using core::BodyUpdate;

/// Input from the link since the last receive().
struct LinkInput {
  bool alive = false;                            ///< at least one valid message arrived
  core::Command command = core::Command::kNone;  ///< command of a message, returned once
  std::uint16_t age_ticks = 0;                   ///< if alive: see core::Input::link_age_ticks
  /// Updates of a message, returned once and valid until the next receive(). The tick bound of a
  /// firmware image covers one update per tick.
  std::span<const BodyUpdate> bodies{};
  core::AddedForce added_force{};  ///< force of a message, returned once
  bool storage_busy = false;       ///< a flash write is in progress: a late tick is not a fault
                                   ///< while the motors are off
};

/// Connection to an application.
///   receive()     returns the input since the last call; drops a message that fails its checks.
///   send(status)  best effort: drops the status if there is no room; never blocks.
template <class T>
concept Link = requires(T& link, const core::Status& status) {
  { link.receive() }
  noexcept->std::same_as<LinkInput>;
  { link.send(status) }
  noexcept->std::same_as<void>;
};

/// Byte transport of a Session (session.hpp): a serial port or a USB endpoint.
///   read(bytes)   copies as many received bytes as fit; returns their number, 0 if there are none.
///   write(bytes)  queues as many bytes as there is room for; returns their number.
template <class T>
concept BytePort = requires(T& port, std::span<std::byte> in, std::span<const std::byte> out) {
  { port.read(in) }
  noexcept->std::same_as<std::size_t>;
  { port.write(out) }
  noexcept->std::same_as<std::size_t>;
};

/// Storage of the model.
///   active()  returns the bytes of the blob in use, 4-byte aligned and readable in place until the
///             next reset; empty if there is none. They are not trusted: open_blob() checks them.
template <class T>
concept BlobStorage = requires(const T& storage) {
  { storage.active() }
  noexcept->std::same_as<std::span<const std::byte>>;
};

/// A complete board. Each function returns a reference to a component.
template <class T>
concept Board = requires(T& board) {
  requires EncoderBank<std::remove_reference_t<decltype(board.encoders())>>;
  requires MotorBank<std::remove_reference_t<decltype(board.motors())>>;
  requires EnableLine<std::remove_reference_t<decltype(board.enable_line())>>;
  requires SafetyInputs<std::remove_reference_t<decltype(board.safety_inputs())>>;
  requires Ticker<std::remove_reference_t<decltype(board.ticker())>>;
  requires Link<std::remove_reference_t<decltype(board.link())>>;
  requires BlobStorage<std::remove_reference_t<decltype(board.storage())>>;
};

}  // namespace tactree::hal
