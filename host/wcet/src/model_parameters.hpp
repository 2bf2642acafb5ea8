#pragma once
// Limits that no model exceeds, in place of values that a formula leaves open.

#include <cstdint>

namespace tactree::wcet {

/// Maximum number of points of a leaf in paper mode, where the format sets no limit. No board
/// renders as many in time.
inline constexpr std::int64_t kMaxLeafPoints = 65535;

}  // namespace tactree::wcet
