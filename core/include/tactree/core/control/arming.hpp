#pragma once
// The second step of arming: from armed to active once the hand confirms and the device is ready. A
// dead-man control that is tied down does not confirm: it must have been released after arming.
//
// Interrupt safe: no shared state.

#include "tactree/core/control/readings.hpp"

namespace tactree::core {

class Arming {
 public:
  /// Call when the state becomes armed.
  void begin() { dead_man_released_ = false; }
  /// Call once per tick outside the armed state.
  void rest() { waiting_ = false; }

  /// Call once per tick in the armed state. `device_ready`: the amplifiers have power and the probe
  /// is in free space. Returns true if the state must become active.
  [[nodiscard]] bool update(const Readings& readings, bool dead_man_required, bool device_ready) {
    dead_man_released_ = dead_man_released_ || !readings.dead_man;
    const bool hand = dead_man_required ? readings.dead_man && dead_man_released_
                                        : readings.command == Command::kArm;
    waiting_ = hand && !device_ready;
    return hand && device_ready;
  }

  /// True if the hand has confirmed but the device is not ready.
  [[nodiscard]] bool waiting() const { return waiting_; }

 private:
  bool waiting_ = false;
  bool dead_man_released_ = false;
};

}  // namespace tactree::core
