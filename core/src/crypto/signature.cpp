// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/crypto/signature.hpp"

#include "field25519.hpp"
#include "tactree/core/crypto/sha512.hpp"

namespace tactree::core {
namespace {

// The curve: -x^2 + y^2 = 1 + d x^2 y^2.
constexpr Field kD = {{0x135978A3, 0x75EB4DCA, 0x4141D8AB, 0x00700A4D, 0x7779E898, 0x8CC74079,
                       0x2B6FFE73, 0x52036CEE}};
constexpr Field kTwiceD = {{0x26B2F159, 0xEBD69B94, 0x8283B156, 0x00E0149A, 0xEEF3D130, 0x198E80F2,
                            0x56DFFCE7, 0x2406D9DC}};
constexpr Field kRootOfMinusOne = {{0x4A0EA0B0, 0xC4EE1B27, 0xAD2FE478, 0x2F431806, 0x3DFBD7A7,
                                    0x2B4D0099, 0x4FC1DF0B, 0x2B832480}};
/// Order of the group that the base point generates.
constexpr std::uint32_t kOrder[8] = {0x5CF5D3ED, 0x5812631A, 0xA2F79CD6, 0x14DEF9DE,
                                     0x00000000, 0x00000000, 0x00000000, 0x10000000};

/// Extended coordinates: x = X / Z, y = Y / Z, x y = T / Z (H. Hisil et al., "Twisted Edwards
/// curves revisited", 2008).
struct Point {
  Field x{};
  Field y = field::kOne;
  Field z = field::kOne;
  Field t{};
};

constexpr Point kBase = {{{0x8F25D51A, 0xC9562D60, 0x9525A7B2, 0x692CC760, 0xFDD6DC5C, 0xC0A4E231,
                           0xCD6E53FE, 0x216936D3}},
                         {{0x66666658, 0x66666666, 0x66666666, 0x66666666, 0x66666666, 0x66666666,
                           0x66666666, 0x66666666}},
                         field::kOne,
                         {{0xA5B7DDA3, 0x6DDE8AB3, 0x775152F5, 0x20F09F80, 0x64ABE37D, 0x66EA4E8E,
                           0xD78B7665, 0x67875F0F}}};

/// Section 3.1 of that paper, for a = -1. Valid for any two points, including equal ones.
Point sum(const Point& p, const Point& q) {
  const Field a = (p.y - p.x) * (q.y - q.x);
  const Field b = (p.y + p.x) * (q.y + q.x);
  const Field c = p.t * kTwiceD * q.t;
  const Field zz = p.z * q.z;
  const Field d = zz + zz;
  const Field e = b - a;
  const Field f = d - c;
  const Field g = d + c;
  const Field h = b + a;
  return {e * f, g * h, f * g, e * h};
}

Point negative(const Point& p) { return {Field{} - p.x, p.y, p.z, Field{} - p.t}; }

/// (p - 5) / 8
constexpr std::uint32_t kRootExponent[8] = {0xFFFFFFFD, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF,
                                            0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0x0FFFFFFF};

/// Computes a square root of u / v as in RFC 8032, section 5.1.3, step 3. Returns false if there is
/// none.
bool root_of_ratio(const Field& u, const Field& v, Field& root) {
  const Field v3 = v * v * v;
  const Field v7 = v3 * v3 * v;
  root = u * v3 * power(u * v7, kRootExponent);
  const Field check = v * root * root;
  if (equal(check, u)) {
    return true;
  }
  root = root * kRootOfMinusOne;
  return equal(check, Field{} - u);
}

/// Decodes a point. Returns false if it is not on the curve, or not canonically encoded.
bool decode(std::span<const std::uint8_t, 32> bytes, Point& point) {
  load_words(bytes, point.y.word);
  const std::uint32_t sign = point.y.word[7] >> 31U;
  point.y.word[7] &= 0x7FFFFFFFU;
  std::uint32_t difference[8];
  if (!field::subtract_words(point.y.word, field::kPrime.word, difference)) {
    return false;  // y is not below p
  }
  const Field yy = point.y * point.y;
  if (!root_of_ratio(yy - field::kOne, kD * yy + field::kOne, point.x)) {
    return false;
  }
  if (is_zero(point.x) && sign != 0U) {
    return false;
  }
  if ((reduced(point.x).word[0] & 1U) != sign) {
    point.x = Field{} - point.x;
  }
  point.z = field::kOne;
  point.t = point.x * point.y;
  return true;
}

bool is_same(const Point& p, const Point& q) {
  return equal(p.x * q.z, q.x * p.z) && equal(p.y * q.z, q.y * p.z);
}

/// True if eight times the point is the neutral element.
bool is_of_small_order(Point point) {
  for (int i = 0; i < 3; ++i) {  // bound: 3
    point = sum(point, point);
  }
  return is_same(point, Point{});
}

/// Reduces a number of 64 bytes modulo the group order, from its most significant bit.
void reduce_scalar(std::span<const std::uint8_t, 64> bytes, std::uint32_t (&scalar)[8]) {
  for (std::uint32_t& word : scalar) {  // bound: 8
    word = 0;
  }
  for (int bit = 511; bit >= 0; --bit) {  // bound: 512
    std::uint32_t carry = (bytes[static_cast<std::size_t>(bit / 8)] >> (bit % 8)) & 1U;
    for (std::uint32_t& word : scalar) {  // bound: 8
      const std::uint32_t top = word >> 31U;
      word = (word << 1U) | carry;
      carry = top;
    }
    std::uint32_t less[8];
    if (!field::subtract_words(scalar, kOrder, less)) {
      __builtin_memcpy(scalar, less, sizeof scalar);
    }
  }
}

bool bit_of(const std::uint32_t (&scalar)[8], int bit) {
  return ((scalar[bit / 32] >> (bit % 32)) & 1U) != 0U;
}

/// a * p + b * q with one doubling per bit (Shamir's trick).
Point sum_of_multiples(const std::uint32_t (&a)[8], const Point& p, const std::uint32_t (&b)[8],
                       const Point& q) {
  const Point both = sum(p, q);
  Point result;
  for (int bit = 252; bit >= 0; --bit) {  // bound: 253
    result = sum(result, result);
    const bool first = bit_of(a, bit);
    const bool second = bit_of(b, bit);
    if (first || second) {
      result = sum(result, first && second ? both : first ? p : q);
    }
  }
  return result;
}

}  // namespace

bool is_signed_by(PublicKeyView key, SignatureView signature, std::span<const std::byte> head,
                  std::span<const std::byte> body) {
  std::uint32_t s[8];
  load_words(signature.last<32>(), s);
  std::uint32_t difference[8];
  if (!field::subtract_words(s, kOrder, difference)) {
    return false;  // S is not below the order
  }
  Point owner;
  Point r;
  if (!decode(key, owner) || !decode(signature.first<32>(), r) || is_of_small_order(owner) ||
      is_of_small_order(r)) {
    return false;
  }
  Sha512 hash;
  hash.update(std::as_bytes(signature.first<32>()));
  hash.update(std::as_bytes(key));
  hash.update(head);
  hash.update(body);
  std::uint8_t digest[Sha512::kBytes];
  hash.finish(digest);
  std::uint32_t k[8];
  reduce_scalar(digest, k);
  return is_same(sum_of_multiples(s, kBase, k, negative(owner)), r);
}

}  // namespace tactree::core
