#pragma once
// A hand that repeats a recorded motion.

#include <span>

#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

/// The positions of the probe in the ticks in which the hand felt the model, those of the state
/// kActive, from time 0. It begins with the first of them without contact, because a hand cannot
/// begin in the object, unless all have contact. Precondition: ascending times. Throws
/// std::invalid_argument if no tick is active.
[[nodiscard]] HandPath repeated_path(std::span<const Sample> recorded);

}  // namespace tactree::simulation
