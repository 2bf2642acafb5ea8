#pragma once
// Device, hand and controller together: does it buzz, and how stiff may it be?

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Vibration of a hand that presses with 1 N and draws the tip over the coarse cosine sheet at
/// 10 mm/s (1 kHz, 1 N/mm, encoder 20 um), and the largest stable stiffness of a device with
/// b = 0.5 Ns/m and no hand at 1, 4 and 10 kHz.
[[nodiscard]] LoopResult measure_loop(bool quick);

}  // namespace tactree::evaluation
