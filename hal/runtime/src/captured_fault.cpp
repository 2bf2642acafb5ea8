// The record is in RAM that start-up does not initialise. Its checksum distinguishes it from the
// random content of RAM after power-up.

#include <cstddef>
#include <span>

#include "tactree/core/math/crc32.hpp"
#include "tactree/runtime/fault_capture.hpp"

namespace tactree::runtime {
namespace {

struct Kept {
  hal::CapturedFault fault;
  std::uint32_t checksum;
};

// A plain array, because start-up would run the constructor of an object.
[[gnu::section(".noinit")]] alignas(Kept) std::byte kept_bytes[sizeof(Kept)];

Kept& kept() { return *reinterpret_cast<Kept*>(kept_bytes); }

std::uint32_t checksum_of(const hal::CapturedFault& fault) {
  return core::crc32(std::as_bytes(std::span(&fault, 1)));
}

}  // namespace

void capture(const hal::CapturedFault& fault) {
  kept().fault = fault;
  kept().checksum = checksum_of(fault);
  reset();
}

hal::CapturedFault take_captured_fault() {
  hal::CapturedFault fault;
  if (kept().checksum == checksum_of(kept().fault)) {
    fault = kept().fault;
  }
  kept().checksum = ~checksum_of(kept().fault);
  return fault;
}

}  // namespace tactree::runtime
