#include "tactree/builder/size_advice.hpp"

#include <fmt/core.h>

#include "tactree/builder/length_text.hpp"

namespace tactree::builder {
namespace {

// Sizes that can be felt with a haptic device. Outside this range the unit is probably wrong.
constexpr double kHugeModel_m = 1.0;
constexpr double kTinyModel_m = 0.005;

}  // namespace

std::optional<std::string> size_advice(double longest_edge_m) {
  const bool huge = longest_edge_m > kHugeModel_m;
  if (!(huge || longest_edge_m < kTinyModel_m) || longest_edge_m == 0.0) {
    return std::nullopt;
  }
  return fmt::format(
      "the model is {} wide, {} (check the unit: build with --unit mm, or --fit 0.2 for 0.2 m)",
      length_text(longest_edge_m),
      huge ? "but a haptic device reaches 0.1 to 0.6 m: a hand can touch only the part around its "
             "origin"
           : "too small to feel by a device that reaches 0.1 to 0.6 m");
}

}  // namespace tactree::builder
