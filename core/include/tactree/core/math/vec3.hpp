#pragma once
// Vectors of three float32 components, and scalar helpers for the control loop, without libm.
//
// Interrupt safety: pure functions.

#if defined(__FAST_MATH__)
#error "Tactree: compile without -ffast-math; it changes the forces, and removes the checks for NaN"
#elif __cplusplus < 202002L
#error "Tactree: compile as C++20 (-std=c++20) or later"
#endif

#include <cstdint>

namespace tactree::core {

struct Vec3 {
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, float s) { return s * a; }
  constexpr Vec3& operator+=(Vec3 b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  constexpr Vec3& operator-=(Vec3 b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  friend constexpr bool operator==(Vec3, Vec3) = default;
};

/// Integer coordinates of a site on a blob's lattice, or of an octree cell.
struct Int3 {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
  friend constexpr bool operator==(Int3, Int3) = default;
};

constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

constexpr float length_squared(Vec3 a) { return a.x * a.x + a.y * a.y + a.z * a.z; }

/// Correctly rounded square root: one instruction on every supported core. Precondition: v >= 0.
inline float square_root(float v) { return __builtin_sqrtf(v); }

inline float length(Vec3 a) { return square_root(length_squared(a)); }

constexpr float absolute(float v) { return v < 0.0F ? -v : v; }

/// Returns false for NaN and infinity.
constexpr bool is_finite(float v) { return v - v == 0.0F; }
constexpr bool is_finite(Vec3 v) {
  return (v.x - v.x) + (v.y - v.y) + (v.z - v.z) == 0.0F;  // one comparison instead of three
}

/// `v` scaled to unit length, or `fallback` if its squared length is at most 1e-30 or not finite.
inline Vec3 normalized_or(Vec3 v, Vec3 fallback) {
  const float squared = length_squared(v);
  if (!(squared > 1e-30F) || !is_finite(squared)) {
    return fallback;
  }
  return (1.0F / square_root(squared)) * v;
}

}  // namespace tactree::core
