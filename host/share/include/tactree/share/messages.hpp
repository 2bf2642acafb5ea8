#pragma once
// The messages between a shared board and its clients, docs/SHARE.md: JSON to values and back.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/share/snapshot.hpp"

namespace tactree::share {

/// What the messages contain under `wireless_verse_grip`.
enum class Grip : std::uint8_t {
  kNeutral,  ///< a grip at rest, for clients that need one
  kNone,
};

/// The client in command.
struct Commander {
  unsigned client = 0;  ///< 0: nobody
  std::string address;
};

/// A state for all clients. `first`: with the description of the board.
[[nodiscard]] std::string state_text(const Snapshot& snapshot, Grip grip,
                                     const Commander& commander, bool first);

/// What a state tells one client about itself.
struct ClientFacts {
  unsigned number = 0;
  bool in_command = false;
  std::uint64_t dropped = 0;      ///< states that were due, and not sent
  std::uint32_t every_ticks = 0;  ///< of the subscription; 0: a state for each message
  friend bool operator==(const ClientFacts&, const ClientFacts&) = default;
};

/// Adds the facts, and why a request was refused, to a text of state_text().
[[nodiscard]] std::string with_facts(const std::string& state, const ClientFacts& facts,
                                     const std::string& refusal);

/// The only message to a client that is not admitted.
[[nodiscard]] std::string refusal_text(const std::string& refusal);

/// What the board executes; in this order if one message contains several.
enum class BoardRequest : std::uint8_t { kConnect, kClear, kHome, kArm };

struct SubscriptionRequest {
  double rate_hz = 0.0;   ///< 0: ends the subscription
  std::size_t queue = 1;  ///< states that may wait
};
inline constexpr std::size_t kMaxQueue = 1024;

/// A message of a client.
struct ClientMessage {
  bool stop = false;
  bool take_command = false;
  bool release_command = false;
  std::vector<BoardRequest> requests;
  std::optional<SubscriptionRequest> subscription;
  std::optional<std::array<float, 3>> force_N;
  std::string refusal;  ///< why a part was not understood; empty: everything was
};

/// Understands as much as possible: a stop counts also in a message that is wrong elsewhere.
[[nodiscard]] ClientMessage read_message(const std::string& text, const std::string& device_id);

}  // namespace tactree::share
