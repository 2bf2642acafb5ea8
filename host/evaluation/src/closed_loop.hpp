#pragma once
// The closed loop of device, hand and controller: vibration and stability.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Vibration while a hand presses with 1 N and moves over the coarse cosine sheet at 10 mm/s (1
/// kHz, 1 N/mm, encoder 20 um); largest stable stiffness of a device with b = 0.5 Ns/m without a
/// hand at 1, 4 and 10 kHz.
[[nodiscard]] LoopResult measure_loop(bool quick);

}  // namespace tactree::evaluation
