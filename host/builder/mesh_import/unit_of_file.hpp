#pragma once
// The unit of length that a mesh file states, or that its format defines.

#include <assimp/scene.h>

#include <string>
#include <string_view>

namespace tactree::builder {

struct FileUnit {
  double metres = 0.0;        ///< per unit of the file; 0: unknown
  bool scene_scaled = false;  ///< the positions of the scene are already in metres
};

/// glTF and X3D: metres; FBX: its UnitScaleFactor; COLLADA: its <unit>, or metres. `hint` is the
/// extension of the format.
[[nodiscard]] FileUnit unit_of_file(const aiScene& scene, const std::string& file,
                                    std::string_view hint);

}  // namespace tactree::builder
