#pragma once
// Reading, changing and waiting for bits of a register. Every wait is bounded: a bit that hardware
// never sets costs a failure with a name, not the control loop.

#include <cstdint>

namespace tactree::firmware::stm32f4 {

template <class Word>
std::uint32_t read(const Word& word) {
  return static_cast<std::uint32_t>(word);
}

template <class Word>
bool has(const Word& word, std::uint32_t mask) {
  return (read(word) & mask) == mask;
}

/// Gives the bits of `mask` the value `bits`; the others stay.
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

/// Reads at most `polls` times. False: the bits of `mask` never had the value `bits`.
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
