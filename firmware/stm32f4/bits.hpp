#pragma once
// Reads, changes and polls bits of a register. Every wait is bounded: a bit that the hardware never
// sets causes a reported failure, not a hanging control loop.
//
// change(), set() and clear() are read-modify-write sequences: they are not interrupt safe for a
// register that two contexts share.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

namespace tactree::firmware::stm32f4 {

template <class Word>
std::uint32_t read(const Word& word) {
  return static_cast<std::uint32_t>(word);
}

/// True if all bits of `mask` are set.
template <class Word>
bool has(const Word& word, std::uint32_t mask) {
  return (read(word) & mask) == mask;
}

/// Sets the bits of `mask` to `bits`; keeps the others.
template <class Word>
void change(Word& word, std::uint32_t mask, std::uint32_t bits) {
  word = (read(word) & ~mask) | bits;
}

template <class Word>
void set(Word& word, std::uint32_t mask) {
  change(word, mask, mask);
}

template <class Word>
void clear(Word& word, std::uint32_t mask) {
  change(word, mask, 0U);
}

/// Polls until the bits of `mask` equal `bits`. Returns false if they do not after `polls` reads.
template <class Word>
[[nodiscard]] bool wait_until(const Word& word, std::uint32_t mask, std::uint32_t bits,
                              std::uint32_t polls) {
  for (std::uint32_t i = 0; i < polls; ++i) {  // bound: polls
    if ((read(word) & mask) == bits) {
      return true;
    }
  }
  return false;
}

}  // namespace tactree::firmware::stm32f4
