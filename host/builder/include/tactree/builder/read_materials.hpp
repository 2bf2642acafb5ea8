#pragma once
// Reads the materials of a model: from a JSON file with one material or one per colour, or from a
// list of properties.
//
//   {"stiffness_N_m": 800, "damping_Ns_m": 1.5, "static_friction": 0.5, "dynamic_friction": 0.4,
//    "texture_height_m": 1e-4, "texture_wavelength_m": 2e-3}
//
//   {"default": {"stiffness_N_m": 800},
//    "colours": [{"name": "felt", "rgb": [255, 0, 0], "tolerance": 30, "stiffness_N_m": 200}]}
//
//   stiffness=800,damping=1.5,static=0.5,dynamic=0.4,texture_height=1e-4,texture_wavelength=2e-3
//
// The stiffness of a model, or of its default, is required; other properties default to 0. A colour
// inherits the default's properties; its tolerance defaults to 30.

#include <string>

#include "tactree/builder/materials.hpp"

namespace tactree::builder {

/// Reads a list of properties if `source` contains '=' and no file of that name exists, otherwise
/// the file `source`. Throws ReadError with file, key, cause and hint.
[[nodiscard]] MaterialMap read_materials(const std::string& source);

}  // namespace tactree::builder
