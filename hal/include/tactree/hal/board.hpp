#pragma once
// What a board must provide, as concepts. A port implements these types, each as small as its
// hardware allows, bundles them in one board type and runs conformance.hpp on it.
//
// For all functions here: they return at once (Ticker::wait() excepted), never throw, never
// allocate, and are called from one context only, that of the control loop. A function that can
// fail says so in what it returns; there is no other channel.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "tactree/core/controller.hpp"

namespace tactree::hal {

/// Position counters of the axes.
///   read()  the counts of now, all latched at one instant; wraps at 2^32. An axis whose counter
///           cannot be trusted (wire broken, index lost) is not valid; its count does not matter.
template <class T>
concept EncoderBank = requires(T& bank) {
  { bank.read() }
  noexcept->std::same_as<core::EncoderReading>;
};

/// Amplifiers and motors.
///   write(command)  the efforts to hold from now on, N or Nm per axis. Before the first write and
///                   whenever the enable line is off, the effort is zero.
///   healthy()       false: an amplifier reports a failure, or a command could not be delivered.
/// A bank that can measure its supply also has, for Configuration::supply_monitored:
///   supply_V()      float, of now.
template <class T>
concept MotorBank = requires(T& bank, const core::MotorCommand& command) {
  { bank.write(command) }
  noexcept->std::same_as<void>;
  { bank.healthy() }
  noexcept->std::same_as<bool>;
};

/// The line that gives the amplifiers their power. Off after reset.
///   set(on)      what it is to be.
///   read_back()  what it is, measured at the amplifiers, not the value last set. It follows
///                within Configuration::enable_timeout_s.
template <class T>
concept EnableLine = requires(T& line, bool on) {
  { line.set(on) }
  noexcept->std::same_as<void>;
  { line.read_back() }
  noexcept->std::same_as<bool>;
};

/// Switches of the person at the device.
///   emergency_stop()  true: pressed. A broken wire reads as pressed.
///   dead_man()        true: held. A broken wire reads as let go.
template <class T>
concept SafetyInputs = requires(T& inputs) {
  { inputs.emergency_stop() }
  noexcept->std::same_as<bool>;
  { inputs.dead_man() }
  noexcept->std::same_as<bool>;
};

/// What a tick's wait tells.
struct Tick {
  std::uint32_t overruns = 0;  ///< deadlines that went by since the last wait; 0: on time
};

/// The heartbeat of the loop, and a clock.
///   wait()    returns at the next tick; at once if that has passed, counting it as an overrun.
///   now_us()  microseconds, wrapping at 2^32, never going back.
template <class T>
concept Ticker = requires(T& ticker) {
  { ticker.wait() }
  noexcept->std::same_as<Tick>;
  { ticker.now_us() }
  noexcept->std::same_as<std::uint32_t>;
};

/// Where a body of the scene is, how it moves on from there, and whether it is there at all.
struct BodyUpdate {
  std::uint32_t body = core::kNoBody;  ///< which; kNoBody: nothing is to change
  bool enabled = true;
  core::Pose pose{};
  core::Motion motion{};
};

/// What came over the link since the last look.
struct LinkInput {
  bool alive = false;                            ///< at least one valid message
  core::Command command = core::Command::kNone;  ///< each message gives its command once
  std::uint16_t age_ticks = 0;                   ///< where alive: see core::Input::link_age_ticks
  BodyUpdate body{};                             ///< each message gives its update once
  std::uint32_t force_ticks = 0;                 ///< 0: no force is to be added
  core::Vec3 force_N{};                          ///< see core::Controller::add_force()
  bool storage_busy = false;  ///< the flash is being written: a late tick is no fault, where
                              ///< the motors are off
};

/// The connection to an application.
///   receive()     what came in; a message that fails its checks is as if it never came.
///   send(status)  best effort: drops it when there is no room, never waits.
template <class T>
concept Link = requires(T& link, const core::Status& status) {
  { link.receive() }
  noexcept->std::same_as<LinkInput>;
  { link.send(status) }
  noexcept->std::same_as<void>;
};

/// Bytes to and from an application: a serial port, a USB endpoint. What a Session (session.hpp)
/// talks over.
///   read(bytes)   what came in, as much as fits; returns how many, 0 when there is nothing.
///   write(bytes)  as many as there is room for; returns how many.
template <class T>
concept BytePort = requires(T& port, std::span<std::byte> in, std::span<const std::byte> out) {
  { port.read(in) }
  noexcept->std::same_as<std::size_t>;
  { port.write(out) }
  noexcept->std::same_as<std::size_t>;
};

/// Where the model is kept.
///   active()  the bytes of the blob in use, 4-byte aligned, readable in place until the next
///             reset; empty when there is none. Not trusted: open_blob() checks them.
template <class T>
concept BlobStorage = requires(const T& storage) {
  { storage.active() }
  noexcept->std::same_as<std::span<const std::byte>>;
};

/// All of it. Each function returns a reference to the part.
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
