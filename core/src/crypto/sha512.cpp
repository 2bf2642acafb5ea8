// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/crypto/sha512.hpp"

namespace tactree::core {
namespace {

constexpr std::size_t kRounds = 80;

// The first 64 bits of the fractional parts of the cube roots of the first 80 primes.
constexpr std::uint64_t kRound[kRounds] = {
    0x428A2F98D728AE22, 0x7137449123EF65CD, 0xB5C0FBCFEC4D3B2F, 0xE9B5DBA58189DBBC,
    0x3956C25BF348B538, 0x59F111F1B605D019, 0x923F82A4AF194F9B, 0xAB1C5ED5DA6D8118,
    0xD807AA98A3030242, 0x12835B0145706FBE, 0x243185BE4EE4B28C, 0x550C7DC3D5FFB4E2,
    0x72BE5D74F27B896F, 0x80DEB1FE3B1696B1, 0x9BDC06A725C71235, 0xC19BF174CF692694,
    0xE49B69C19EF14AD2, 0xEFBE4786384F25E3, 0x0FC19DC68B8CD5B5, 0x240CA1CC77AC9C65,
    0x2DE92C6F592B0275, 0x4A7484AA6EA6E483, 0x5CB0A9DCBD41FBD4, 0x76F988DA831153B5,
    0x983E5152EE66DFAB, 0xA831C66D2DB43210, 0xB00327C898FB213F, 0xBF597FC7BEEF0EE4,
    0xC6E00BF33DA88FC2, 0xD5A79147930AA725, 0x06CA6351E003826F, 0x142929670A0E6E70,
    0x27B70A8546D22FFC, 0x2E1B21385C26C926, 0x4D2C6DFC5AC42AED, 0x53380D139D95B3DF,
    0x650A73548BAF63DE, 0x766A0ABB3C77B2A8, 0x81C2C92E47EDAEE6, 0x92722C851482353B,
    0xA2BFE8A14CF10364, 0xA81A664BBC423001, 0xC24B8B70D0F89791, 0xC76C51A30654BE30,
    0xD192E819D6EF5218, 0xD69906245565A910, 0xF40E35855771202A, 0x106AA07032BBD1B8,
    0x19A4C116B8D2D0C8, 0x1E376C085141AB53, 0x2748774CDF8EEB99, 0x34B0BCB5E19B48A8,
    0x391C0CB3C5C95A63, 0x4ED8AA4AE3418ACB, 0x5B9CCA4F7763E373, 0x682E6FF3D6B2B8A3,
    0x748F82EE5DEFB2FC, 0x78A5636F43172F60, 0x84C87814A1F0AB72, 0x8CC702081A6439EC,
    0x90BEFFFA23631E28, 0xA4506CEBDE82BDE9, 0xBEF9A3F7B2C67915, 0xC67178F2E372532B,
    0xCA273ECEEA26619C, 0xD186B8C721C0C207, 0xEADA7DD6CDE0EB1E, 0xF57D4F7FEE6ED178,
    0x06F067AA72176FBA, 0x0A637DC5A2C898A6, 0x113F9804BEF90DAE, 0x1B710B35131C471B,
    0x28DB77F523047D84, 0x32CAAB7B40C72493, 0x3C9EBE0A15C9BEBC, 0x431D67C49C100D4C,
    0x4CC5D4BECB3E42B6, 0x597F299CFC657E2A, 0x5FCB6FAB3AD6FAEC, 0x6C44198C4A475817,
};

constexpr std::uint64_t turn(std::uint64_t word, unsigned bits) {
  return (word >> bits) | (word << (64U - bits));
}

std::uint64_t load_big_endian(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  for (unsigned i = 0; i < 8U; ++i) {  // bound: 8
    word = (word << 8U) | bytes[i];
  }
  return word;
}

/// One word of the message schedule.
constexpr std::uint64_t next_word(const std::uint64_t (&w)[16], std::size_t i) {
  const std::uint64_t a = w[(i + 1U) % 16U];
  const std::uint64_t b = w[(i + 14U) % 16U];
  const std::uint64_t small0 = turn(a, 1) ^ turn(a, 8) ^ (a >> 7U);
  const std::uint64_t small1 = turn(b, 19) ^ turn(b, 61) ^ (b >> 6U);
  return w[i % 16U] + small0 + w[(i + 9U) % 16U] + small1;
}

/// One round; the eight words are s[0] = a .. s[7] = h.
void add_round(std::uint64_t (&s)[8], std::uint64_t word) {
  const std::uint64_t big1 = turn(s[4], 14) ^ turn(s[4], 18) ^ turn(s[4], 41);
  const std::uint64_t choice = (s[4] & s[5]) ^ (~s[4] & s[6]);
  const std::uint64_t t1 = s[7] + big1 + choice + word;
  const std::uint64_t big0 = turn(s[0], 28) ^ turn(s[0], 34) ^ turn(s[0], 39);
  const std::uint64_t majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
  const std::uint64_t t2 = big0 + majority;
  for (unsigned i = 7; i > 0U; --i) {  // bound: 7
    s[i] = s[i - 1U];
  }
  s[4] += t1;
  s[0] = t1 + t2;
}

}  // namespace

void Sha512::add_block() {
  std::uint64_t w[16];
  for (std::size_t i = 0; i < 16U; ++i) {  // bound: 16
    w[i] = load_big_endian(block_ + 8U * i);
  }
  std::uint64_t s[8];
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    s[i] = state_[i];
  }
  for (std::size_t i = 0; i < kRounds; ++i) {  // bound: kRounds
    if (i >= 16U) {
      w[i % 16U] = next_word(w, i);
    }
    add_round(s, w[i % 16U] + kRound[i]);
  }
  for (std::size_t i = 0; i < 8U; ++i) {  // bound: 8
    state_[i] += s[i];
  }
  used_ = 0;
}

void Sha512::update(std::span<const std::byte> bytes) {
  total_ += bytes.size();
  for (const std::byte byte : bytes) {  // bound: bytes_size
    block_[used_] = static_cast<std::uint8_t>(byte);
    ++used_;
    if (used_ == kBlock) {
      add_block();
    }
  }
}

void Sha512::finish(std::span<std::uint8_t, kBytes> hash) {
  const std::uint64_t bits = 8U * total_;
  constexpr std::byte kEnd{0x80};
  constexpr std::byte kZero{0};
  update(std::span(&kEnd, 1));
  while (used_ != kBlock - 16U) {  // bound: 127
    update(std::span(&kZero, 1));
  }
  for (unsigned i = 0; i < 8U; ++i) {  // bound: 8
    block_[kBlock - 16U + i] = 0;      // upper half of the length
  }
  for (unsigned i = 0; i < 8U; ++i) {  // bound: 8
    block_[kBlock - 8U + i] = static_cast<std::uint8_t>(bits >> (56U - 8U * i));
  }
  add_block();
  for (std::size_t i = 0; i < kBytes; ++i) {  // bound: 64
    hash[i] = static_cast<std::uint8_t>(state_[i / 8U] >> (56U - 8U * (i % 8U)));
  }
}

}  // namespace tactree::core
