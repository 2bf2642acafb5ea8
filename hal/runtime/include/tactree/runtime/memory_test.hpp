#pragma once
// A test of RAM at start-up, before its first use: of all variables, not of the stack in use.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>

namespace tactree::runtime {

/// March C- with one word and its complement (van de Goor, "Using march tests to test SRAMs", IEEE
/// Design & Test 1993). Detects stuck-at and transition faults of each bit, coupling faults between
/// words, and address decoder faults. Overwrites the range. Cost: eleven accesses per word. `Word`
/// is std::uint32_t, or in tests a simulated word with faults.
template <class Word>
[[nodiscard]] bool holds_all_bits(Word* begin, Word* end) {
  std::uint32_t held = 0x55555555U;
  std::uint32_t wrong = 0;
  volatile Word* word = begin;
  for (; word < end; ++word) {  // bound: tested_words
    *word = held;
  }
  for (std::uint32_t pass = 0; pass < 5; ++pass) {  // bound: 5
    const bool upwards = pass >= 3U;
    word = upwards ? begin : end;
    for (std::ptrdiff_t left = end - begin; left > 0; --left) {  // bound: tested_words
      word -= upwards ? 0 : 1;
      wrong |= *word ^ held;
      *word = ~held;
      word += upwards ? 1 : 0;
    }
    held = ~held;
  }
  return wrong == 0U;
}

}  // namespace tactree::runtime
