#include "tactree/core/device/quadrature.hpp"

#include <gtest/gtest.h>

namespace tactree::core {
namespace {

constexpr QuadratureLevels kForward[] = {
    {false, false}, {true, false}, {true, true}, {false, true}};

TEST(Quadrature, CountsFourStepsPerPeriod) {
  QuadratureDecoder decoder;
  for (int i = 1; i <= 400; ++i) {
    decoder.step(kForward[i % 4]);
  }
  EXPECT_EQ(decoder.count(), 400U);
  for (int i = 399; i >= -400; --i) {
    decoder.step(kForward[((i % 4) + 4) % 4]);
  }
  EXPECT_EQ(static_cast<std::int32_t>(decoder.count()), -400);
  EXPECT_EQ(decoder.illegal(), 0U);
}

TEST(Quadrature, IgnoresSimultaneousEdges) {
  QuadratureDecoder decoder;
  decoder.step({true, true});
  decoder.step({false, false});
  EXPECT_EQ(decoder.count(), 0U);
  EXPECT_EQ(decoder.illegal(), 2U);
  decoder.step({false, false});
  EXPECT_EQ(decoder.illegal(), 2U) << "nothing has changed";
}

TEST(Quadrature, StartsFromLineLevels) {
  QuadratureDecoder decoder;
  decoder.begin({true, true});
  decoder.step({false, true});
  EXPECT_EQ(decoder.count(), 1U);
  EXPECT_EQ(decoder.illegal(), 0U);
}

}  // namespace
}  // namespace tactree::core
