#pragma once
// What a shared board reports: its description once per session, and a snapshot of each tick.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tactree/client/client.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::share {

struct Description {
  std::string device_id;  ///< serial number of the board, or its name if it has none
  std::string name;
  std::string firmware;
  core::wire::CapabilitiesReply can{};
  core::Vec3 origin_m{};                      ///< of the model frame, in the frame of the device
  std::optional<std::string> model_name;      ///< boards do not report it
  std::optional<std::uint32_t> model_points;  ///< unknown for the model of an image
};

enum class Link : std::uint8_t {
  kHere,
  kLost,   ///< the board is looked for
  kTaken,  ///< by another program: until a client requests the connection
};

/// Why a request failed that the board or the link refused later.
struct News {
  std::uint64_t number = 0;
  std::string text;
};

struct Snapshot {
  client::Telemetry tick{};
  /// Time of the board since the first tick of this program. Does not advance while it is lost.
  std::uint64_t time_us = 0;
  std::uint64_t dropped = 0;  ///< ticks that this program did not get, see client::Board::dropped()
  Link link = Link::kHere;
  std::string why;  ///< of a link that is not kHere
  News news{};
  std::shared_ptr<const Description> board;  ///< another object in each session; never null
};

}  // namespace tactree::share
