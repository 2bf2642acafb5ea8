#pragma once
// Angles in float32. Each constant is one literal, not an expression of another one: a product that
// rounds differently would change the forces in their last bit.
//
// Interrupt safety: constants.

namespace tactree::core {

inline constexpr float kTwoPi = 6.2831853F;        ///< rad
inline constexpr float kDegree = 0.017453293F;     ///< rad
inline constexpr float kQuarterTurn = 1.5707963F;  ///< rad; pi / 2 rounded down, not to nearest

}  // namespace tactree::core
