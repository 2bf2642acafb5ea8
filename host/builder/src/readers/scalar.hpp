#pragma once
// Numbers in binary files: the ten scalar types of PLY and PCD.

#include <bit>
#include <cstdint>
#include <cstring>

namespace tactree::builder {

enum class ScalarType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
};

[[nodiscard]] constexpr std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    default:
      return 8;
  }
}

[[nodiscard]] constexpr bool is_float(ScalarType type) {
  return type == ScalarType::kFloat32 || type == ScalarType::kFloat64;
}

/// Loads an unsigned integer at `from`; `Swap` reverses the byte order.
template <typename Unsigned, bool Swap>
[[nodiscard]] inline Unsigned load_bits(const char* from) {
  Unsigned bits{};
  std::memcpy(&bits, from, sizeof bits);
  if constexpr (Swap && sizeof bits == 2) return __builtin_bswap16(bits);
  if constexpr (Swap && sizeof bits == 4) return __builtin_bswap32(bits);
  if constexpr (Swap && sizeof bits == 8) return __builtin_bswap64(bits);
  return bits;
}

/// Loads the number of the given type at `from`. Reads size_of(type) bytes.
template <bool Swap>
[[nodiscard]] inline double load_scalar(const char* from, ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
      return static_cast<std::int8_t>(*from);
    case ScalarType::kUint8:
      return static_cast<std::uint8_t>(*from);
    case ScalarType::kInt16:
      return static_cast<std::int16_t>(load_bits<std::uint16_t, Swap>(from));
    case ScalarType::kUint16:
      return load_bits<std::uint16_t, Swap>(from);
    case ScalarType::kInt32:
      return static_cast<std::int32_t>(load_bits<std::uint32_t, Swap>(from));
    case ScalarType::kUint32:
      return load_bits<std::uint32_t, Swap>(from);
    case ScalarType::kInt64:
      return static_cast<double>(static_cast<std::int64_t>(load_bits<std::uint64_t, Swap>(from)));
    case ScalarType::kUint64:
      return static_cast<double>(load_bits<std::uint64_t, Swap>(from));
    case ScalarType::kFloat32:
      return static_cast<double>(std::bit_cast<float>(load_bits<std::uint32_t, Swap>(from)));
    case ScalarType::kFloat64:
      return std::bit_cast<double>(load_bits<std::uint64_t, Swap>(from));
  }
  return 0.0;
}

static_assert(std::endian::native == std::endian::little, "files are read on little-endian hosts");

}  // namespace tactree::builder
