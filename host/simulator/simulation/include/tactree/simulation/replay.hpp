#pragma once
// Replays a recorded session on a new controller. The outcomes must be bit-identical, because a
// tick depends on the controller's state and its Input only; their checksums are compared.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/model/blob.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

struct Difference {
  std::uint64_t tick = 0;  ///< 0: the first tick of the recording
  std::string cause;       ///< for messages
};

struct ReplayResult {
  Summary summary{};                     ///< of the ticks after the start of the trace
  std::uint64_t ticks = 0;               ///< all replayed ticks
  std::optional<Difference> difference;  ///< first difference; ends the replay
  [[nodiscard]] bool same() const { return !difference.has_value(); }
};

/// `models` are in the order of the recording and must outlive the call. Precondition: their number
/// and digests are those of the recording.
[[nodiscard]] ReplayResult replay(Recording& recording, const std::vector<core::BlobView>& models);

}  // namespace tactree::simulation
