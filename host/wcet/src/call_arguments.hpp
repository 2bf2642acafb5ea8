#pragma once
// Values of a call's arguments, for callees whose bounds name their arguments.

#include <cstdint>

#include "analysis.hpp"

namespace tactree::wcet {

/// Maximum values of the arguments that the callee's bounds name, at the call that ends block `b`
/// of function `entry`. A value is a constant in the register, an argument that the caller passes
/// on, or a `with:` annotation. Throws BoundError if there is none of these.
[[nodiscard]] Parameters call_arguments(const Analysis& analysis, const NameValues& values,
                                        std::uint32_t entry, std::uint32_t b);

}  // namespace tactree::wcet
