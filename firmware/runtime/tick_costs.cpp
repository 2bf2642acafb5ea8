// Of this very image: `tactree bound --embed` writes it here after it was linked. Nothing in this
// file reads it: a compiler that does not see who does cannot take it for the zeros it is compiled
// to.

#include "platform.hpp"

extern "C" const tactree::core::TickCosts tactree_tick_costs;
[[gnu::used, gnu::section(".tick_costs")]] const tactree::core::TickCosts tactree_tick_costs = {};

const tactree::core::TickCosts& tactree::firmware::tick_costs() { return tactree_tick_costs; }
