#include "geometry/morton.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint64_t kCoordinateBits = 0x1FFFFFU;

/// Moves bit i to bit 3 i.
std::uint64_t spread(std::uint64_t v) {
  v &= kCoordinateBits;
  v = (v | v << 32) & 0x001F00000000FFFFU;
  v = (v | v << 16) & 0x001F0000FF0000FFU;
  v = (v | v << 8) & 0x100F00F00F00F00FU;
  v = (v | v << 4) & 0x10C30C30C30C30C3U;
  return (v | v << 2) & 0x1249249249249249U;
}

/// Moves bit 3 i to bit i.
int gather(std::uint64_t v) {
  v &= 0x1249249249249249U;
  v = (v | v >> 2) & 0x10C30C30C30C30C3U;
  v = (v | v >> 4) & 0x100F00F00F00F00FU;
  v = (v | v >> 8) & 0x001F0000FF0000FFU;
  v = (v | v >> 16) & 0x001F00000000FFFFU;
  return static_cast<int>((v | v >> 32) & kCoordinateBits);
}

}  // namespace

std::uint64_t morton_code(const Eigen::Vector3i& cell) {
  return spread(static_cast<std::uint64_t>(cell.x())) |
         spread(static_cast<std::uint64_t>(cell.y())) << 1 |
         spread(static_cast<std::uint64_t>(cell.z())) << 2;
}

Eigen::Vector3i morton_cell(std::uint64_t code) {
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

}  // namespace tactree::builder
