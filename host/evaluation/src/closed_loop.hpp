#pragma once
// The closed loop of device, hand and controller: vibration and stability.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Measures the vibration while a hand presses with 1 N and moves over the coarse cosine sheet at
/// 10 mm/s (1 kHz, 1 N/mm, encoder step 20 um), the maximum stable stiffness of a device with
/// b = 0.5 Ns/m without a hand at 1, 4 and 10 kHz, and the stability limits of LoopResult::Limit.
[[nodiscard]] LoopResult measure_loop(bool quick);

}  // namespace tactree::evaluation
