#pragma once
// Upper bounds of the cycles of a tick, in the image itself. `tactree bound --embed` writes them
// into the linked image; before, they are unknown and every model is admitted:
//
//   controller.know_costs(tactree::runtime::tick_costs(), clock_hz);   // before Loop::start()

#include "tactree/core/control/tick_cost.hpp"

namespace tactree::runtime {

[[nodiscard]] const core::TickCosts& tick_costs();

}  // namespace tactree::runtime
