#pragma once
// What --material says: the figures of one material, or a file that tells one or several by colour.
//
//   stiffness=800,damping=1.5,static=0.5,dynamic=0.4,texture_height=1e-4,texture_wavelength=2e-3
//
//   {"stiffness_N_m": 800, "damping_Ns_m": 1.5, "static_friction": 0.5, "dynamic_friction": 0.4,
//    "texture_height_m": 1e-4, "texture_wavelength_m": 2e-3}
//
//   {"default": {"stiffness_N_m": 800},
//    "colours": [{"name": "felt", "rgb": [255, 0, 0], "tolerance": 30, "stiffness_N_m": 200}]}
//
// Only the stiffness of a model, or of its default, has to be told; the rest is 0. What a colour
// does not tell is as in the default; its tolerance is 30.

#include <string>

#include "tactree/builder/materials.hpp"

namespace tactree::cli {

/// Throws CommandError that names file, key, cause and remedy.
[[nodiscard]] builder::MaterialMap read_materials(const std::string& option);

}  // namespace tactree::cli
