#pragma once
// Replays a recorded session on a new controller and compares the outcomes bit for bit: a tick
// depends on the controller's state and its Input only.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/model/blob.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

struct Difference {
  std::uint64_t tick = 0;  ///< from 0, the first of the recording
  std::string cause;       ///< description
};

struct ReplayResult {
  Summary summary{};                     ///< of the ticks after the begin of the trace
  std::uint64_t ticks = 0;               ///< all replayed ticks
  std::optional<Difference> difference;  ///< first difference; ends the replay
  [[nodiscard]] bool same() const { return !difference.has_value(); }
};

/// `models`: in the order of the recording; must outlive the call. Precondition: same number and
/// digests as in the recording.
[[nodiscard]] ReplayResult replay(Recording& recording, const std::vector<core::BlobView>& models);

}  // namespace tactree::simulation
