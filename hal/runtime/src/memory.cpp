// The four functions that a compiler may call implicitly. Compiler flags prevent it from replacing
// these loops by calls of the functions themselves.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>

namespace {

bool aligned(const void* a, const void* b) {
  return ((reinterpret_cast<std::uintptr_t>(a) | reinterpret_cast<std::uintptr_t>(b)) & 3U) == 0U;
}

// The bounds of copies are valid if objects of 16 bytes or more are word-aligned, as all structures
// of a tick are.

// Words that may alias any type.
using Word [[gnu::may_alias]] = std::uint32_t;

// Four words per pass: a tick clears and copies about 1000 bytes of structures.
struct [[gnu::may_alias]] Block {
  Word words[4];
};

struct [[gnu::may_alias]] Pair {
  Word words[2];
};

}  // namespace

extern "C" {

void* memcpy(void* __restrict to, const void* __restrict from, std::size_t bytes) {
  auto* target = static_cast<unsigned char*>(to);
  const auto* source = static_cast<const unsigned char*>(from);
  if (aligned(to, from)) {
    for (; bytes >= sizeof(Block); bytes -= sizeof(Block)) {  // bound: bytes / 16
      *reinterpret_cast<Block*>(target) = *reinterpret_cast<const Block*>(source);
      target += sizeof(Block);
      source += sizeof(Block);
    }
    for (; bytes >= 4; bytes -= 4, target += 4, source += 4) {  // bound: bytes % 16 / 4
      *reinterpret_cast<Word*>(target) = *reinterpret_cast<const Word*>(source);
    }
  }
  for (; bytes > 0; --bytes) {  // bound: max(bytes % 4, (1 - min(bytes / 16, 1)) * bytes)
    *target++ = *source++;
  }
  return to;
}

void* memmove(void* to, const void* from, std::size_t bytes) {
  auto* target = static_cast<unsigned char*>(to);
  const auto* source = static_cast<const unsigned char*>(from);
  if (reinterpret_cast<std::uintptr_t>(target) - reinterpret_cast<std::uintptr_t>(source) >=
      bytes) {
    return memcpy(to, from, bytes);  // the target does not begin within the source
  }
  while (bytes > 0) {  // bound: bytes
    --bytes;
    target[bytes] = source[bytes];
  }
  return to;
}

// The compiler may clear the tail of a structure from an unaligned address. The bytes before the
// first word and after the last word then add up to bytes % 4 or bytes % 4 + 4. A size of whole
// words is cleared from a word's address.
void* memset(void* to, int value, std::size_t bytes) {
  auto* target = static_cast<unsigned char*>(to);
  const auto byte = static_cast<unsigned char>(value);
  const std::uint32_t word = byte * 0x01010101U;
  if (aligned(to, reinterpret_cast<const void*>(bytes))) {
    unsigned char* const last = target + bytes / sizeof(Block) * sizeof(Block);
    for (; target != last; target += sizeof(Block)) {  // bound: bytes / 16
      *reinterpret_cast<Block*>(target) = {word, word, word, word};
    }
    if ((bytes & 8U) != 0U) {
      *reinterpret_cast<Pair*>(target) = {word, word};
      target += sizeof(Pair);
    }
    if ((bytes & 4U) != 0U) {
      *reinterpret_cast<Word*>(target) = word;
    }
    return to;
  }
  // total: min(bytes % 4, 1) * (bytes % 4 + 4) per memset together bytes
  for (; bytes > 0 && !aligned(target, nullptr); --bytes) {  // bound: min(bytes, 3)
    *target++ = byte;
  }
  for (; bytes >= 4; bytes -= 4, target += 4) {  // bound: min(bytes % 4, 1) * (bytes / 4)
    *reinterpret_cast<Word*>(target) = word;
  }
  // total: min(bytes % 4, 1) * (bytes % 4 + 4) per memset together bytes
  for (; bytes > 0; --bytes) {  // bound: min(bytes, 3)
    *target++ = byte;
  }
  return to;
}

int memcmp(const void* a, const void* b, std::size_t bytes) {
  const auto* left = static_cast<const unsigned char*>(a);
  const auto* right = static_cast<const unsigned char*>(b);
  for (; bytes > 0; --bytes, ++left, ++right) {  // bound: bytes
    if (*left != *right) {
      return *left < *right ? -1 : 1;
    }
  }
  return 0;
}

}  // extern "C"
