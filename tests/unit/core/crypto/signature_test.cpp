// Ed25519: vectors of RFC 8032, signatures that must be refused, comparison with libsodium.

#include "tactree/core/crypto/signature.hpp"

#include <gtest/gtest.h>
#include <sodium.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "tactree/core/crypto/sha512.hpp"

namespace tactree::core {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

bool ours(const Bytes& key, const Bytes& signature, const Bytes& message, std::size_t split = 0) {
  const auto bytes = std::as_bytes(std::span(message));
  return is_signed_by(PublicKeyView(key), SignatureView(signature), bytes.first(split),
                      bytes.subspan(split));
}

bool sodiums(const Bytes& key, const Bytes& signature, const Bytes& message) {
  return crypto_sign_verify_detached(signature.data(), message.data(), message.size(),
                                     key.data()) == 0;
}

struct Signed {
  Bytes key = Bytes(kPublicKeyBytes);
  Bytes signature = Bytes(kSignatureBytes);
  Bytes message;
};

Signed random_signed(std::mt19937& random) {
  std::array<std::uint8_t, crypto_sign_SEEDBYTES> seed{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
  for (std::uint8_t& byte : seed) {
    byte = static_cast<std::uint8_t>(random());
  }
  Signed s;
  s.message.resize(random() % 300U);
  for (std::uint8_t& byte : s.message) {
    byte = static_cast<std::uint8_t>(random());
  }
  crypto_sign_seed_keypair(s.key.data(), secret.data(), seed.data());
  crypto_sign_detached(s.signature.data(), nullptr, s.message.data(), s.message.size(),
                       secret.data());
  return s;
}

void flip(Bytes& bytes, std::size_t bit) {
  bytes[bit / 8U] ^= static_cast<std::uint8_t>(1U << (bit % 8U));
}

TEST(Signature, VerifiesRfc8032Vectors) {
  struct Vector {
    const char* key;
    const char* message;
    const char* signature;
  };
  for (const Vector& v :
       {Vector{
            "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a", "",
            "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e"
            "39701cf9b46bd25bf5f0595bbe24655141438e7a100b"},
        Vector{
            "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c", "72",
            "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da085ac1e43e15996e458f"
            "3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00"},
        Vector{
            "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025", "af82",
            "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac18ff9b538d16f290ae67"
            "f760984dc6594a7c15e9716ed28dc027beceea1ec40a"}}) {
    EXPECT_TRUE(ours(from_hex(v.key), from_hex(v.signature), from_hex(v.message)));
  }
}

TEST(Signature, MatchesSha512OfLibsodium) {
  for (std::size_t size = 0; size <= 400; ++size) {
    Bytes message(size, static_cast<std::uint8_t>(size));
    Sha512 hash;
    hash.update(std::as_bytes(std::span(message)));
    std::array<std::uint8_t, 64> got{};
    std::array<std::uint8_t, 64> wanted{};
    hash.finish(got);
    crypto_hash_sha512(wanted.data(), message.data(), message.size());
    ASSERT_EQ(got, wanted) << size;
  }
}

TEST(Signature, RefusesEveryFlippedBit) {
  std::mt19937 random(1);
  Signed s = random_signed(random);
  while (s.message.size() < 8U) {
    s = random_signed(random);
  }
  ASSERT_TRUE(ours(s.key, s.signature, s.message));
  for (std::size_t bit = 0; bit < 8U * kSignatureBytes; ++bit) {
    Signed bad = s;
    flip(bad.signature, bit);
    EXPECT_FALSE(ours(bad.key, bad.signature, bad.message)) << "signature, bit " << bit;
  }
  for (std::size_t bit = 0; bit < 8U * kPublicKeyBytes; ++bit) {
    Signed bad = s;
    flip(bad.key, bit);
    EXPECT_FALSE(ours(bad.key, bad.signature, bad.message)) << "key, bit " << bit;
  }
  for (std::size_t bit = 0; bit < 64U; ++bit) {
    Signed bad = s;
    flip(bad.message, bit);
    EXPECT_FALSE(ours(bad.key, bad.signature, bad.message)) << "message, bit " << bit;
  }
}

TEST(Signature, VerifiesSplitMessage) {
  std::mt19937 random(2);
  const Signed s = random_signed(random);
  for (std::size_t split = 0; split <= s.message.size(); split += 17U) {
    EXPECT_TRUE(ours(s.key, s.signature, s.message, split));
  }
}

// S + L fits the equation as well: one message would have two signatures.
TEST(Signature, RefusesUnreducedScalars) {
  const Bytes order = from_hex("edd3f55c1a631258d69cf7a2def9de1400000000000000000000000000000010");
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    Signed s = random_signed(random);
    unsigned carry = 0;
    for (std::size_t j = 0; j < 32U; ++j) {
      carry += static_cast<unsigned>(s.signature[32U + j]) + order[j];
      s.signature[32U + j] = static_cast<std::uint8_t>(carry);
      carry >>= 8U;
    }
    ASSERT_EQ(carry, 0U);
    EXPECT_FALSE(ours(s.key, s.signature, s.message));
  }
}

// The eight points of small order, and their other encodings: with such a key, or R, a signature of
// S = 0 is valid for every message, or every eighth.
TEST(Signature, RefusesSmallOrderPoints) {
  const std::vector<std::string> points = {
      "0100000000000000000000000000000000000000000000000000000000000000",
      "0100000000000000000000000000000000000000000000000000000000000080",
      "ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
      "ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
      "0000000000000000000000000000000000000000000000000000000000000000",
      "0000000000000000000000000000000000000000000000000000000000000080",
      "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc05",
      "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc85",
      "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac037a",
      "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac03fa",
      "edffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
      "edffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
      "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
      "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"};
  std::mt19937 random(4);
  for (const std::string& key : points) {
    for (const std::string& r : points) {
      Bytes signature = from_hex(r);
      signature.resize(kSignatureBytes, 0);
      for (int i = 0; i < 4; ++i) {
        const Bytes message(static_cast<std::size_t>(random() % 20U), 7);
        EXPECT_FALSE(ours(from_hex(key), signature, message));
      }
    }
  }
  // And each in a signature that is otherwise sound.
  const Signed s = random_signed(random);
  for (const std::string& point : points) {
    Signed bad = s;
    const Bytes r = from_hex(point);
    std::copy(r.begin(), r.end(), bad.signature.begin());
    EXPECT_FALSE(ours(bad.key, bad.signature, bad.message));
    EXPECT_FALSE(ours(r, s.signature, s.message));
  }
}

// Of a y that is 2 on the curve's equation there is no x.
TEST(Signature, RefusesEncodingsOfNoPoint) {
  std::mt19937 random(5);
  const Signed s = random_signed(random);
  Bytes none(kPublicKeyBytes, 0);
  none[0] = 2;
  EXPECT_EQ(crypto_core_ed25519_is_valid_point(none.data()), 0);
  EXPECT_FALSE(ours(none, s.signature, s.message));
}

TEST(Signature, AgreesWithLibsodium) {
  ASSERT_GE(sodium_init(), 0);
  std::mt19937 random(6);
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    Signed s = random_signed(random);
    if (i % 3 == 1) {
      Bytes* const parts[] = {&s.key, &s.signature, &s.message};
      Bytes& part = *parts[random() % 3U];
      if (!part.empty()) {
        flip(part, random() % (8U * part.size()));
      }
    } else if (i % 3 == 2) {
      for (std::uint8_t& byte : s.signature) {
        byte = static_cast<std::uint8_t>(random());
      }
      s.signature[63] &= 0x1FU;
    }
    const bool verdict = ours(s.key, s.signature, s.message);
    ASSERT_EQ(verdict, sodiums(s.key, s.signature, s.message)) << i;
    accepted += verdict ? 1 : 0;
  }
  EXPECT_GE(accepted, 1000);
}

}  // namespace
}  // namespace tactree::core
