#pragma once
// Unusual floats: limits, denormals, NaN, infinities.

#include <array>
#include <limits>

namespace tactree::test {

inline constexpr std::array<float, 13> kOddFloats = {
    0.0F,
    -0.0F,
    std::numeric_limits<float>::denorm_min(),
    -std::numeric_limits<float>::denorm_min(),
    std::numeric_limits<float>::min(),
    1.0F,
    -1.0F,
    std::numeric_limits<float>::max(),
    std::numeric_limits<float>::lowest(),
    std::numeric_limits<float>::infinity(),
    -std::numeric_limits<float>::infinity(),
    std::numeric_limits<float>::quiet_NaN(),
    -std::numeric_limits<float>::quiet_NaN(),
};

}  // namespace tactree::test
