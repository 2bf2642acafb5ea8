// Properties that the core requires of processor and compiler: IEEE single precision, exact to the
// bit, with denormals. The known answers are from x86-64.

#include <bit>
#include <span>

#include "check.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::test {
namespace {

// Values hidden from the compiler.
float opaque(float value) {
  volatile float hidden = value;
  return hidden;
}

float float_of(std::uint32_t bits) { return std::bit_cast<float>(bits); }

template <class Operation>
std::uint32_t checksum_over(std::uint32_t seed, const Operation& operation) {
  Numbers numbers(seed);
  core::Crc32 crc;
  for (int i = 0; i < 20000; ++i) {
    const float a = float_of(numbers.next());
    const float b = float_of(numbers.next());
    float result = operation(a, b);
    result = result == result ? result : 0.0F;  // the bits of a NaN are the processor's affair
    crc.update(std::as_bytes(std::span(&result, 1)));
  }
  return crc.value();
}

}  // namespace

void test_arithmetic() {
  const char digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  TACTREE_CHECK(core::crc32(std::as_bytes(std::span(digits))) == 0xCBF43926U);

  volatile std::uint32_t word = 0xF0F0A501U;
  TACTREE_CHECK(std::popcount(static_cast<std::uint32_t>(word)) == 13);
  TACTREE_CHECK(std::countr_zero(static_cast<std::uint32_t>(word) << 7U) == 7);
  TACTREE_CHECK(std::countl_zero(static_cast<std::uint32_t>(word) >> 5U) == 5);

  TACTREE_CHECK(core::square_root(opaque(2.0F)) == float_of(0x3FB504F3U));
  TACTREE_CHECK(core::square_root(opaque(float_of(0x00000001U))) == float_of(0x1A3504F3U));
  TACTREE_CHECK(opaque(float_of(0x00000003U)) + opaque(float_of(0x00000004U)) ==
                float_of(0x00000007U));
  TACTREE_CHECK(opaque(0x1p-126F) * 0.5F == float_of(0x00400000U));
  TACTREE_CHECK(opaque(1.0F) / opaque(3.0F) == float_of(0x3EAAAAABU));
  // With one rounding less the difference would not be zero.
  const float third = opaque(1.0F) / 3.0F;
  const float product = opaque(third) * third;
  TACTREE_CHECK(opaque(third) * opaque(third) - opaque(product) == 0.0F);
  TACTREE_CHECK(!core::is_finite(opaque(3e38F) * 10.0F));

  TACTREE_CHECK_ANSWER(checksum_over(1, [](float a, float b) { return a + b; }), 0x8F102BA2U);
  TACTREE_CHECK_ANSWER(checksum_over(2, [](float a, float b) { return a * b; }), 0x15A0FA53U);
  TACTREE_CHECK_ANSWER(checksum_over(3, [](float a, float b) { return a / b; }), 0x039441CBU);
  TACTREE_CHECK_ANSWER(checksum_over(4, [](float a, float b) { return a * b - a; }), 0xAA44BE13U);
  TACTREE_CHECK_ANSWER(
      checksum_over(5, [](float a, float) { return core::square_root(core::absolute(a)); }),
      0x7FAD0B16U);
}

}  // namespace tactree::test
