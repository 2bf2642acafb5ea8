#pragma once
// Messages between an emulated board and its simulation, over two byte streams, in lockstep: one
// message per tick in each direction. Both sides are little-endian and use the same layout of these
// structs, so floats are transferred bit-identically. Both sides trust each other as parts of one
// simulation.
//
//   board -> host   Hello              after every reset
//   host -> board   Session
//   board -> host   Started            result of the start
//   host -> board   TickInput          each tick; kFinish in the last one ends the board's program
//   board -> host   TickOutput         each tick, when the board waits for the next one
//
// Every message starts with its kind.

#include <cstdint>
#include <type_traits>

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/captured_fault.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::hal::plant_link {

/// Incremented with every change of these messages or of the structs in them.
inline constexpr std::uint32_t kVersion = 5;

enum class Kind : std::uint32_t {
  kHello = 0x54414331,  ///< unlikely at the start of other data
  kSession,
  kStarted,
  kTickInput,
  kTickOutput,
  kFinish,  ///< in place of kTickInput
};

/// Paths at which the emulated board opens the streams.
inline constexpr char kToBoard[] = "/dev/fd/3";
inline constexpr char kFromBoard[] = "/dev/fd/4";

struct Hello {
  Kind kind = Kind::kHello;
  std::uint32_t version = kVersion;
  std::uint32_t configuration_bytes = sizeof(core::Configuration);
  std::uint32_t status_bytes = sizeof(core::Status);
  std::uint32_t blob_address = 0;
  std::uint32_t blob_bytes_max = 0;
  char board[24] = {};  ///< its name, zero-terminated
  CapturedFault last_fault{};
};

struct SessionSetup {
  Kind kind = Kind::kSession;
  core::Configuration configuration{};
  std::uint32_t served = 0;  ///< 1: an application uses the board's serial port, not the link of
                             ///< the messages below
};

struct Started {
  Kind kind = Kind::kStarted;
  StartResult result{};
};

struct TickInput {
  Kind kind = Kind::kTickInput;
  core::Readings input{};
  BodyUpdate body{};
  bool arm_button = false;  ///< true: pressed, see hal::Panel
};

struct TickOutput {
  Kind kind = Kind::kTickOutput;
  float effort[core::kAxes] = {};  ///< N or Nm
  bool enable = false;
  bool lamp = false;  ///< on, see hal::Panel
  core::Status status{};
};

// Same layout on every core: no pointer, no member wider than four bytes.
static_assert(std::is_trivially_copyable_v<core::Configuration> &&
              std::is_trivially_copyable_v<core::Readings> &&
              std::is_trivially_copyable_v<BodyUpdate> &&
              std::is_trivially_copyable_v<core::Status>);
static_assert(alignof(SessionSetup) == 4 && alignof(TickInput) == 4 && alignof(TickOutput) == 4);
static_assert(sizeof(Hello) == 124 && sizeof(Started) == 8 && sizeof(TickInput) == 124);

}  // namespace tactree::hal::plant_link
