#pragma once
// Linear fade of the force of a contact that ended without the probe leaving the surface, for
// example at a surface boundary. Interrupt safe: no shared state.
//
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

class ForceFade {
 public:
  /// Starts a fade from `force`, N, to 0 in `ticks` >= 1 ticks. The remainder of an earlier fade is
  /// added to it. Cost: constant.
  void begin(Vec3 force, std::uint32_t ticks) {
    from_ = active() ? share() * from_ + force : force;
    ticks_ = ticks;
    left_ = ticks;
  }
  void stop() { left_ = 0; }
  [[nodiscard]] bool active() const { return left_ > 0U; }

  /// Force of the next tick, N. Call once a tick.
  [[nodiscard]] Vec3 next() {
    left_ -= active() ? 1U : 0U;
    return active() ? share() * from_ : Vec3{};
  }

 private:
  [[nodiscard]] float share() const {
    return static_cast<float>(left_) / static_cast<float>(ticks_);
  }

  Vec3 from_{};
  std::uint32_t ticks_ = 1;
  std::uint32_t left_ = 0;
};

}  // namespace tactree::core
