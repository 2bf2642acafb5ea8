#include "tactree/builder/length_text.hpp"

#include <gtest/gtest.h>

#include "tactree/builder/size_advice.hpp"

namespace tactree::builder {
namespace {

TEST(LengthText, HasFittingUnit) {
  EXPECT_EQ(length_text(0.0), "0 mm");
  EXPECT_EQ(length_text(5e-5), "50 um");
  EXPECT_EQ(length_text(3.1141e-3), "3.114 mm");
  EXPECT_EQ(length_text(0.9999), "999.9 mm");
  EXPECT_EQ(length_text(0.99996), "1 m");
  EXPECT_EQ(length_text(9999.4), "9999 m");
  EXPECT_EQ(length_text(123456.0), "123.5 km");
  EXPECT_EQ(length_text(12345678.0), "12346 km");
  EXPECT_EQ(length_text(0.0123456, 6), "12.3456 mm");
}

TEST(LengthText, UsesOneUnitPerSize) {
  EXPECT_EQ(size_text({238.5, 494.2, 20.0}), "238.5 x 494.2 x 20 m");
  EXPECT_EQ(size_text({238500.0, 494200.0, 20.0}), "238.5 x 494.2 x 0.02 km");
  EXPECT_EQ(size_text({0.06, 0.04, 0.0}), "60 x 40 x 0 mm");
  EXPECT_EQ(size_text({0.06, 1e-9, 0.0}), "60 x 0.000001 x 0 mm");
  EXPECT_EQ(size_text({2e7, 1e7, 0.0}), "20000 x 10000 x 0 km");
  EXPECT_EQ(place_text({-0.0125, 0.002, -0.0}), "(-12.5, 2, 0) mm");
}

TEST(SizeAdvice, IsGivenForImplausibleSizes) {
  EXPECT_FALSE(size_advice(0.0));
  EXPECT_FALSE(size_advice(0.005));
  EXPECT_FALSE(size_advice(1.0));
  EXPECT_NE(size_advice(1.01)->find("1.01 m wide, but a haptic device reaches"), std::string::npos);
  EXPECT_NE(size_advice(0.0049)->find("4.9 mm wide, too small"), std::string::npos);
}

}  // namespace
}  // namespace tactree::builder
