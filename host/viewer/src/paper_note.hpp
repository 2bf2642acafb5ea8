#pragma once
// Why a hand in the object feels nothing with the method of the paper.

#include <string>

#include "tactree/simulation/simulation.hpp"
#include "tactree/viewer/frame.hpp"

namespace tactree::viewer {

/// For the page; empty while the controller is not active, at a contact, and in front of all
/// surfaces. Deeper than the reach of a blob without an interior, also empty.
[[nodiscard]] std::string paper_note(const simulation::Sample& sample, const Bodies& bodies);

}  // namespace tactree::viewer
