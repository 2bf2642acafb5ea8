#include "tactree/runtime/self_test.hpp"

namespace tactree::runtime {

hal::ImageStatus test_program() {
  // The compiler must not fold the constants: seal-image changes them after the build.
  const ImageRecord* record = &tactree_image;
  __asm volatile("" : "+r"(record)::"memory");
  const auto in_memory = [](std::uint32_t address, std::uint32_t bytes) {
    return std::span(reinterpret_cast<const std::byte*>(std::uintptr_t{address}), bytes);
  };
  const bool holds = record != nullptr && holds_program(*record, in_memory);
  return holds ? hal::ImageStatus::kOk : hal::ImageStatus::kDamaged;
}

}  // namespace tactree::runtime
