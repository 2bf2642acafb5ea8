#pragma once
// What an emulated board and the simulation that drives it tell each other, over two byte streams,
// in lockstep: one message each way per tick. Both sides are little-endian and lay these structs
// out alike, so that every float arrives with its bits. The host trusts the board and the board the
// host: they are parts of one simulation.
//
//   board -> host   Hello              after every reset
//   host -> board   Session
//   board -> host   Started            the model was taken, or why not
//   host -> board   TickInput          each tick; the last one has kFinish: the board ends
//   board -> host   TickOutput         each tick, when the board waits for the next
//
// Every message begins with its kind.

#include <cstdint>
#include <type_traits>

#include "tactree/core/controller.hpp"
#include "tactree/hal/captured_fault.hpp"
#include "tactree/hal/loop.hpp"

namespace tactree::hal::plant_link {

/// Changes with every change of what follows, or of the structs in it.
inline constexpr std::uint32_t kVersion = 4;

enum class Kind : std::uint32_t {
  kHello = 0x54414331,  ///< no message begins with these bytes by chance
  kSession,
  kStarted,
  kTickInput,
  kTickOutput,
  kFinish,  ///< in place of kTickInput
};

/// The streams, as the emulated board opens them.
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

struct Session {
  Kind kind = Kind::kSession;
  core::Configuration configuration{};
  std::uint32_t served = 0;  ///< 1: an application is at the board's serial port; the link of the
                             ///< messages below is not used
};

struct Started {
  Kind kind = Kind::kStarted;
  StartResult result{};
};

struct TickInput {
  Kind kind = Kind::kTickInput;
  core::Input input{};
  BodyUpdate body{};
};

struct TickOutput {
  Kind kind = Kind::kTickOutput;
  float effort[core::kAxes] = {};  ///< N or Nm
  bool enable = false;
  core::Status status{};
};

// Alike on every core: no pointer, nothing wider than four bytes.
static_assert(std::is_trivially_copyable_v<core::Configuration> &&
              std::is_trivially_copyable_v<core::Input> &&
              std::is_trivially_copyable_v<BodyUpdate> &&
              std::is_trivially_copyable_v<core::Status>);
static_assert(alignof(Session) == 4 && alignof(TickInput) == 4 && alignof(TickOutput) == 4);
static_assert(sizeof(Hello) == 124 && sizeof(Started) == 8 && sizeof(TickInput) == 120);

}  // namespace tactree::hal::plant_link
