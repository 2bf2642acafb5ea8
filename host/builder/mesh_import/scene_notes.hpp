#pragma once
// What the text of a file states that the scene of assimp does not.

#include <string>

namespace tactree::builder {

struct SceneNotes {
  double unit_m = 0.0;  ///< metres per unit; 0: as the format has it
  std::string warning;  ///< sentences; may be empty
};

}  // namespace tactree::builder
