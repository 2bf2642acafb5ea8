// The costs of a tick of this image. `tactree bound --embed` writes them here after linking. No
// code in this file reads their values, because the compiler would replace them by the zeros of the
// initialiser.

#include "tactree/runtime/admission.hpp"

// NOLINTBEGIN(readability-identifier-naming): the name of a symbol in the image
extern "C" const tactree::core::TickCosts tactree_tick_costs;
[[gnu::used, gnu::section(".tick_costs")]] const tactree::core::TickCosts tactree_tick_costs = {};
// NOLINTEND(readability-identifier-naming)

const tactree::core::TickCosts& tactree::runtime::tick_costs() { return tactree_tick_costs; }
