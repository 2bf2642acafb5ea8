#pragma once
// The force of a contact that ended without the probe leaving the surface: it does not snap to
// zero, but goes down in a straight line. Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/vec3.hpp"

namespace tactree::core {

class ForceFade {
 public:
  /// What is left of an earlier force fades together with this one. `ticks` >= 1: the force is 0
  /// from the tick that many after its last.
  void begin(Vec3 force, std::uint32_t ticks) {
    from_ = active() ? share() * from_ + force : force;
    ticks_ = ticks;
    left_ = ticks;
  }
  void stop() { left_ = 0; }
  [[nodiscard]] bool active() const { return left_ > 0U; }

  /// The force of the next tick; once a tick.
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
