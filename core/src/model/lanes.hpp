#pragma once
// SIMD lanes: four floats or integers per instruction on cores with vector instructions, otherwise
// one. Both use IEEE arithmetic, so the results are bit-identical.

#include <cstdint>

namespace tactree::core {

#if defined(__SSE2__) || defined(__aarch64__)

inline constexpr std::uint32_t kLanes = 4;
using Floats = float __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));
using Words = std::uint32_t __attribute__((vector_size(16)));
using Mask = Integers;  // per lane: all ones or 0

inline Floats all(float v) { return Floats{v, v, v, v}; }
inline Integers all(std::int32_t v) { return Integers{v, v, v, v}; }
inline Integers ascending_from(std::int32_t first) { return first + Integers{0, 1, 2, 3}; }
inline Integers ascending_to(std::int32_t first, std::int32_t last) {  // last <= first + 2
  return Integers{first, first < last ? first + 1 : last, last, last};
}

template <typename Lanes, typename T>
Lanes load(const T* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <typename Lanes, typename T>
void store(Lanes lanes, T* to) {
  __builtin_memcpy(to, &lanes, sizeof lanes);
}
inline Words gather(const std::uint32_t* from, Integers index) {
  return Words{from[index[0]], from[index[1]], from[index[2]], from[index[3]]};
}

inline Floats to_floats(Integers v) { return __builtin_convertvector(v, Floats); }
inline Floats to_floats(Words v) { return to_floats((Integers)v); }  // each lane below 2^31
inline Integers to_integers(Floats v) { return __builtin_convertvector(v, Integers); }
inline Integers as_integers(Floats v) { return (Integers)v; }
inline Floats as_floats(Integers bits) { return (Floats)bits; }

#ifdef __SSE2__
inline Floats smaller(Floats a, Floats b) { return __builtin_ia32_minps(a, b); }
inline std::uint32_t mask_bits(Mask mask) {  // one bit per lane
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps((Floats)mask));
}
#else
inline Floats smaller(Floats a, Floats b) { return a < b ? a : b; }
inline std::uint32_t mask_bits(Mask mask) {
  const Words bits = (Words)mask & Words{1, 2, 4, 8};
  return bits[0] | bits[1] | bits[2] | bits[3];
}
#endif
inline constexpr std::uint32_t kAllBits = 15;
inline Integers ones_if(Mask mask) { return mask; }
inline Integers select(Mask mask, Integers a, Integers b) { return b ^ (mask & (a ^ b)); }

inline float smallest(Floats v) {
  const float low = v[0] < v[1] ? v[0] : v[1];
  const float high = v[2] < v[3] ? v[2] : v[3];
  return low < high ? low : high;
}
inline std::int32_t smallest(Integers v) {
  const std::int32_t low = v[0] < v[1] ? v[0] : v[1];
  const std::int32_t high = v[2] < v[3] ? v[2] : v[3];
  return low < high ? low : high;
}

#else

inline constexpr std::uint32_t kLanes = 1;
using Floats = float;
using Integers = std::int32_t;
using Words = std::uint32_t;
using Mask = bool;

inline Floats all(float v) { return v; }
inline Integers all(std::int32_t v) { return v; }
inline Integers ascending_from(std::int32_t first) { return first; }
inline Integers ascending_to(std::int32_t first, std::int32_t) { return first; }

template <typename Lanes, typename T>
Lanes load(const T* from) {
  return static_cast<Lanes>(*from);
}
template <typename Lanes, typename T>
void store(Lanes lanes, T* to) {
  *to = static_cast<T>(lanes);
}
inline Words gather(const std::uint32_t* from, Integers index) { return from[index]; }

inline Floats to_floats(Integers v) { return static_cast<float>(v); }
inline Floats to_floats(Words v) { return to_floats(static_cast<std::int32_t>(v)); }
inline Integers to_integers(Floats v) { return static_cast<std::int32_t>(v); }
inline Integers as_integers(Floats v) { return __builtin_bit_cast(std::int32_t, v); }
inline Floats as_floats(Integers bits) { return __builtin_bit_cast(float, bits); }

inline Floats smaller(Floats a, Floats b) { return a < b ? a : b; }
inline std::uint32_t mask_bits(Mask mask) { return mask ? 1U : 0U; }
inline constexpr std::uint32_t kAllBits = 1;
inline Integers ones_if(Mask mask) { return mask ? -1 : 0; }
inline Integers select(Mask mask, Integers a, Integers b) { return mask ? a : b; }

inline Floats smallest(Floats v) { return v; }
inline Integers smallest(Integers v) { return v; }

#endif

}  // namespace tactree::core
