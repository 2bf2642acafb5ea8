#pragma once
// Predefined paths of the hand, fitted to any model.

#include <string>
#include <vector>

#include "tactree/core/model/blob.hpp"
#include "tactree/simulation/hand_path.hpp"

namespace tactree::simulation {

/// rub    touches down from outside and rubs to and fro over the surface, up to 0.1 m/s
/// press  touches down at the centre and presses with a periodically changing depth
/// trace  moves in circles with a light touch
/// hover  moves above the model without touching it
[[nodiscard]] const std::vector<std::string>& script_names();

/// Path of the script `name` for a model, with a duration of `seconds`. The hand approaches from
/// the side that most of the surface faces. Throws std::invalid_argument for an unknown name and
/// for an empty model.
[[nodiscard]] HandPath make_script(const std::string& name, const core::BlobView& view,
                                   double seconds);

}  // namespace tactree::simulation
