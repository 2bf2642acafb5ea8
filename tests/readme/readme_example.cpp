// The function in README.md measures a sphere, from both sides, and refuses a damaged blob.
#include <cmath>
#include <cstdio>

#include "readme_function.hpp"
#include "test_models.hpp"

int main() {
  const tactree::test::TestBlob sphere(tactree::test::sphere(0.03, 0.001));
  const auto& bytes = sphere.written().bytes;
  const float outside = distance_to_surface(bytes, {0.031F, 0.0F, 0.0F});
  const float inside = distance_to_surface(bytes, {0.0F, 0.029F, 0.0F});
  const float damaged =
      distance_to_surface(std::span(bytes).first(bytes.size() - 4), {0.031F, 0.0F, 0.0F});
  const float far_away = distance_to_surface(bytes, {1.0F, 0.0F, 0.0F});
  std::printf("outside %.6f, inside %.6f, damaged %.6f, far away %.6f\n",
              static_cast<double>(outside), static_cast<double>(inside),
              static_cast<double>(damaged), static_cast<double>(far_away));
  const bool good = std::abs(outside - 0.001F) < 5e-5F && std::abs(inside + 0.001F) < 5e-5F;
  return good && damaged == 0.0F && far_away == 0.0F ? 0 : 1;
}
