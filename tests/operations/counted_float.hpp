#pragma once
// A float that counts what is done with it. Included before anything else, it takes the place of
// `float` in all code of core that follows: the same source, counted.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <span>
#include <type_traits>
#include <vector>

namespace tactree::test {

using PlainFloat = float;

/// Operations since the program began: + - * / square root, comparison, conversion; not a change of
/// sign, which costs nothing of its own.
inline std::uint64_t operations = 0;

class CountedFloat {
 public:
  constexpr CountedFloat() = default;
  template <std::floating_point T>
  constexpr CountedFloat(T v) : v_(static_cast<PlainFloat>(v)) {}
  template <std::integral T>
  constexpr CountedFloat(T v) : v_(static_cast<PlainFloat>(v)) {
    count();
  }
  template <std::integral T>
  constexpr explicit operator T() const {
    count();
    return static_cast<T>(v_);
  }
  [[nodiscard]] constexpr PlainFloat plain() const { return v_; }

  friend constexpr CountedFloat operator-(CountedFloat a) { return -a.v_; }
  friend constexpr CountedFloat operator+(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ + b.v_;
  }
  friend constexpr CountedFloat operator-(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ - b.v_;
  }
  friend constexpr CountedFloat operator*(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ * b.v_;
  }
  friend constexpr CountedFloat operator/(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ / b.v_;
  }
  constexpr CountedFloat& operator+=(CountedFloat b) { return *this = *this + b; }
  constexpr CountedFloat& operator-=(CountedFloat b) { return *this = *this - b; }
  constexpr CountedFloat& operator*=(CountedFloat b) { return *this = *this * b; }
  constexpr CountedFloat& operator/=(CountedFloat b) { return *this = *this / b; }
  friend constexpr bool operator==(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ == b.v_;
  }
  friend constexpr auto operator<=>(CountedFloat a, CountedFloat b) {
    count();
    return a.v_ <=> b.v_;
  }

 private:
  static constexpr void count() {
    if (!std::is_constant_evaluated()) {
      ++operations;
    }
  }

  PlainFloat v_;
};

inline CountedFloat counted_square_root(CountedFloat v) {
  ++operations;
  return std::sqrt(v.plain());
}

}  // namespace tactree::test

template <>
struct std::numeric_limits<tactree::test::CountedFloat> : std::numeric_limits<float> {};

#define float ::tactree::test::CountedFloat
#define __builtin_sqrtf ::tactree::test::counted_square_root
