#pragma once
// Arithmetic modulo p = 2^255 - 19 in eight words of 32 bits, least significant first. Between
// operations a number is below 2^256, not necessarily below p; reduced() returns the representative
// below p. Since 2^256 = 38 (mod p), a carry out of the top word is multiplied by 38 and added to
// the lowest word.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

struct Field {
  std::uint32_t word[8] = {};
};

namespace field {

inline constexpr Field kPrime = {{0xFFFFFFED, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF,
                                  0xFFFFFFFF, 0xFFFFFFFF, 0x7FFFFFFF}};
inline constexpr Field kOne = {{1}};

/// Computes a - b without reduction modulo p; returns the borrow.
inline bool subtract_words(const std::uint32_t (&a)[8], const std::uint32_t (&b)[8],
                           std::uint32_t (&difference)[8]) {
  std::uint64_t borrow = 0;
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    const std::uint64_t word = std::uint64_t{a[i]} - b[i] - borrow;
    difference[i] = static_cast<std::uint32_t>(word);
    borrow = (word >> 32U) & 1U;
  }
  return borrow != 0U;
}

/// Adds `small` to the lowest word; returns the carry out of the top word.
inline std::uint64_t add_small(Field& a, std::uint64_t small) {
  std::uint64_t carry = small;
  for (std::uint32_t& word : a.word) {  // bound: 8
    carry += word;
    word = static_cast<std::uint32_t>(carry);
    carry >>= 32U;
  }
  return carry;
}

/// Adds a carry out of the top word back in. This may cause a second carry of 1, but never a third.
inline void fold(Field& a, std::uint64_t carry) {
  carry = add_small(a, 38U * carry);
  (void)add_small(a, 38U * carry);
}

}  // namespace field

inline Field operator+(const Field& a, const Field& b) {
  Field sum;
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    carry += std::uint64_t{a.word[i]} + b.word[i];
    sum.word[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32U;
  }
  field::fold(sum, carry);
  return sum;
}

/// A borrow out of the top word has added 2^256 = 38 (mod p), which is subtracted. This may borrow
/// once more.
inline Field operator-(const Field& a, const Field& b) {
  Field difference;
  bool borrowed = field::subtract_words(a.word, b.word, difference.word);
  for (int i = 0; i < 2; ++i) {  // bound: 2
    const std::uint32_t back[8] = {borrowed ? 38U : 0U};
    borrowed = field::subtract_words(difference.word, back, difference.word);
  }
  return difference;
}

inline Field operator*(const Field& a, const Field& b) {
  std::uint32_t product[16] = {};
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < 8U; ++j) {  // bound: 8
      carry += std::uint64_t{a.word[i]} * b.word[j] + product[i + j];
      product[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32U;
    }
    product[i + 8U] = static_cast<std::uint32_t>(carry);
  }
  Field low;
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    carry += std::uint64_t{product[i]} + 38U * std::uint64_t{product[i + 8U]};
    low.word[i] = static_cast<std::uint32_t>(carry);
    carry >>= 32U;
  }
  field::fold(low, carry);
  return low;
}

/// The representative below p.
inline Field reduced(Field a) {
  for (int i = 0; i < 2; ++i) {  // bound: 2 (2^256 is below 3 p)
    Field less;
    if (!field::subtract_words(a.word, field::kPrime.word, less.word)) {
      a = less;
    }
  }
  return a;
}

inline bool equal(const Field& a, const Field& b) {
  const Field x = reduced(a);
  const Field y = reduced(b);
  std::uint32_t different = 0;
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    different |= x.word[i] ^ y.word[i];
  }
  return different == 0U;
}

inline bool is_zero(const Field& a) { return equal(a, Field{}); }

/// base^exponent. Cost: 256 squarings, and one product per set bit of the exponent.
inline Field power(const Field& base, const std::uint32_t (&exponent)[8]) {
  Field result = field::kOne;
  for (int bit = 255; bit >= 0; --bit) {  // bound: 256
    result = result * result;
    if (((exponent[bit / 32] >> (bit % 32)) & 1U) != 0U) {
      result = result * base;
    }
  }
  return result;
}

/// 1 / a, computed as a^(p - 2) by Fermat's little theorem; 0 for a = 0.
inline Field inverse(const Field& a) {
  constexpr std::uint32_t kExponent[8] = {0xFFFFFFEB, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF,
                                          0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0x7FFFFFFF};
  return power(a, kExponent);
}

inline void load_words(std::span<const std::uint8_t, 32> bytes, std::uint32_t (&word)[8]) {
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    word[i] = static_cast<std::uint32_t>(bytes[4U * i]) |
              static_cast<std::uint32_t>(bytes[4U * i + 1U]) << 8U |
              static_cast<std::uint32_t>(bytes[4U * i + 2U]) << 16U |
              static_cast<std::uint32_t>(bytes[4U * i + 3U]) << 24U;
  }
}

}  // namespace tactree::core
