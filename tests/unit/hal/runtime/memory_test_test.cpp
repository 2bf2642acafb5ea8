// The RAM test at start-up, on memories with every kind of fault that a march test detects.

#include "tactree/runtime/memory_test.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace tactree::test {
namespace {

constexpr std::uint32_t kWords = 16;

/// A memory; the hooks simulate faults.
struct Memory {
  std::uint32_t cells[kWords] = {};
  std::function<void(Memory&, std::uint32_t word, std::uint32_t before)> written;
  std::function<std::uint32_t(std::uint32_t word)> decoded;

  std::uint32_t cell_of(std::uint32_t word) const { return decoded ? decoded(word) : word; }
  std::uint32_t read(std::uint32_t word) const { return cells[cell_of(word)]; }
  void write(std::uint32_t word, std::uint32_t value) {
    const std::uint32_t before = cells[cell_of(word)];
    cells[cell_of(word)] = value;
    if (written) {
      written(*this, word, before);
    }
  }
};

Memory memory;

/// A word of the memory; its address is its index in `all`.
struct Word {
  static Word all[kWords];
  [[nodiscard]] std::uint32_t number() const volatile {
    return static_cast<std::uint32_t>(this - all);
  }
  operator std::uint32_t() const volatile { return memory.read(number()); }
  void operator=(std::uint32_t value) volatile { memory.write(number(), value); }
  char place = 0;
};
Word Word::all[kWords];

bool holds() { return runtime::holds_all_bits(Word::all, Word::all + kWords); }

class RamTest : public testing::Test {
 protected:
  RamTest() { memory = {}; }
};

TEST_F(RamTest, PassesWorkingMemory) {
  for (std::uint32_t& cell : memory.cells) {
    cell = 0xDEADBEEFU;
  }
  EXPECT_TRUE(holds());
}

TEST_F(RamTest, DetectsEveryStuckBit) {
  for (std::uint32_t word = 0; word < kWords; ++word) {
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
      for (const bool at_one : {false, true}) {
        memory.written = [=](Memory& m, std::uint32_t, std::uint32_t) {
          m.cells[word] = at_one ? m.cells[word] | (1U << bit) : m.cells[word] & ~(1U << bit);
        };
        EXPECT_FALSE(holds()) << word << " " << bit << " " << at_one;
      }
    }
  }
}

TEST_F(RamTest, DetectsEveryTransitionFault) {
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    for (const bool rises : {false, true}) {
      memory.written = [=](Memory& m, std::uint32_t word, std::uint32_t before) {
        const std::uint32_t changed = (before ^ m.cells[word]) & (1U << bit);
        const bool risen = (changed & m.cells[word]) != 0U;
        if (word == 5 && changed != 0U && risen == rises) {
          m.cells[word] ^= changed;
        }
      };
      EXPECT_FALSE(holds()) << bit << " " << rises;
    }
  }
}

TEST_F(RamTest, DetectsCouplingFaults) {
  for (std::uint32_t from = 0; from < kWords; ++from) {
    for (std::uint32_t to = 0; to < kWords; ++to) {
      if (from != to) {
        memory.written = [=](Memory& m, std::uint32_t word, std::uint32_t before) {
          if (word == from && m.cells[word] != before) {
            m.cells[to] ^= 8U;
          }
        };
        EXPECT_FALSE(holds()) << from << " " << to;
      }
    }
  }
}

TEST_F(RamTest, DetectsAddressDecoderFaults) {
  for (std::uint32_t line = 1; line < kWords; line *= 2) {
    memory.decoded = [=](std::uint32_t word) { return word & ~line; };
    EXPECT_FALSE(holds()) << line;
  }
}

TEST_F(RamTest, PassesEmptyRange) { EXPECT_TRUE(runtime::holds_all_bits(Word::all, Word::all)); }

}  // namespace
}  // namespace tactree::test
