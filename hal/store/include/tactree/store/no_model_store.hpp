#pragma once
// The store of a board whose model is part of its image: ModelTransfer refuses every update.

#include <cstdint>

namespace tactree::store {

class NoModelStore {
 public:
  static constexpr std::uint32_t kSlots = 0;
  [[nodiscard]] static std::uint32_t slot_bytes() { return 0; }
  [[nodiscard]] static bool signature_required() { return false; }
};

}  // namespace tactree::store
