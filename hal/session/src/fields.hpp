#pragma once
// Copies values of the controller to fields of messages.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>

#include "tactree/core/math/vec3.hpp"

namespace tactree::session {

inline void copy(core::Vec3 from, float (&to)[3]) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

/// Truncates text that is too long; `to` stays zero-terminated. Precondition: `to` is all zero.
template <std::size_t N>
void copy(const char* from, char (&to)[N]) {
  for (std::size_t i = 0; i + 1 < N && from[i] != '\0'; ++i) {  // bound: N
    to[i] = from[i];
  }
}

}  // namespace tactree::session
