// The image's own memcpy() and its kin, at every alignment.

#include <cstddef>
#include <cstring>

#include "check.hpp"

namespace tactree::test {
namespace {

constexpr std::size_t kSize = 64;

// Through volatile pointers, or the compiler would do the work itself.
void* (*volatile copy)(void*, const void*, std::size_t) = std::memcpy;
void* (*volatile move)(void*, const void*, std::size_t) = std::memmove;
void* (*volatile fill)(void*, int, std::size_t) = std::memset;
int (*volatile compare)(const void*, const void*, std::size_t) = std::memcmp;

struct Bytes {
  alignas(4) unsigned char at[kSize];
  Bytes() {
    for (std::size_t i = 0; i < kSize; ++i) {
      at[i] = static_cast<unsigned char>(i + 1);
    }
  }
};

bool moves(std::size_t to, std::size_t from, std::size_t bytes) {
  Bytes buffer;
  const Bytes before;
  bool good = move(buffer.at + to, buffer.at + from, bytes) == buffer.at + to;
  for (std::size_t i = 0; i < kSize; ++i) {
    const bool moved = i >= to && i < to + bytes;
    good = good && buffer.at[i] == (moved ? before.at[i - to + from] : before.at[i]);
  }
  return good;
}

bool copies_and_fills(std::size_t to, std::size_t from, std::size_t bytes) {
  Bytes target;
  const Bytes source;
  bool good = copy(target.at + to, source.at + from, bytes) == target.at + to;
  for (std::size_t i = 0; i < kSize; ++i) {
    const bool copied = i >= to && i < to + bytes;
    good = good && target.at[i] == source.at[copied ? i - to + from : i];
  }
  good = good && fill(target.at + to, 0x1AB, bytes) == target.at + to;
  for (std::size_t i = 0; i < kSize; ++i) {
    good = good && target.at[i] == (i >= to && i < to + bytes ? 0xAB : source.at[i]);
  }
  return good;
}

}  // namespace

void test_memory() {
  for (std::size_t to = 0; to < 8; ++to) {
    for (std::size_t from = 0; from < 8; ++from) {
      for (std::size_t bytes = 0; bytes < 24; ++bytes) {
        TACTREE_CHECK(copies_and_fills(to, from, bytes));
        TACTREE_CHECK(moves(to, from, bytes));
      }
    }
  }
  Bytes a;
  Bytes b;
  TACTREE_CHECK(compare(a.at, b.at, kSize) == 0);
  b.at[40] = 200;
  TACTREE_CHECK(compare(a.at, b.at, kSize) < 0);
  TACTREE_CHECK(compare(b.at, a.at, kSize) > 0);
  TACTREE_CHECK(compare(a.at, b.at, 40) == 0);
}

}  // namespace tactree::test
