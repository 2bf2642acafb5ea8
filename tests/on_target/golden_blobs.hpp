#pragma once
// The files of tests/golden/, and memory that ends where a blob in it ends.

#include <cstddef>
#include <span>

namespace tactree::test {

enum class Golden { kSurface, kPaper };

[[nodiscard]] std::span<const std::byte> golden(Golden which);

inline constexpr std::size_t kExactBytesMax = 16384;
/// `size` writable bytes, 4-byte aligned at their begin, with nothing behind their end where the
/// machine permits: reading on is a fault. Always the same memory.
[[nodiscard]] std::span<std::byte> exact_buffer(std::size_t size);

}  // namespace tactree::test
