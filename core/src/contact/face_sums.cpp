// The sums over the points of each face, at its level.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <limits>

#include "contact/passes.hpp"

namespace tactree::core {

[[gnu::noinline]] Level level_of(const Candidate* nearest, Vec3 x, Vec3 normal) {
  if (nearest == nullptr) {
    return {normal, 0.0F, std::numeric_limits<float>::quiet_NaN()};
  }
  const Vec3 q = nearest->position - x;
  return {normal, dot(q, normal), dot(q, nearest->normal)};
}

[[gnu::noinline]] DividedSums sum_faces(const CandidateSet& points, Vec3 x, float radius,
                                        const Seeds& seeds, const Division& division) {
  const SupportSquare square{radius * radius, 1.0F / (radius * radius)};
  const Face none{};
  Face first;
  Face second;
  Face third;
  const auto level_at = [&](const Nearest& nearest, Vec3 normal) {
    return level_of(division.has_levels ? nearest.point : nullptr, x, normal);
  };
  const Level of_first = level_at(division.nearest[0], seeds.normal[0]);
  const Level of_second = level_at(division.nearest[1], seeds.normal[1]);
  const Level of_third = level_at(division.nearest[2], seeds.normal[2]);
  const auto add_front = [&](std::uint32_t i, const Level& level, Face& face) {
    add_to_face(points, x, square, division.point[i], division.facing[i], level, none, face);
  };
  const auto add_back = [&](std::uint32_t i, const Level& level, Face& face) {
    const std::uint32_t count = division.averted[i];
    add_to_face(points, x, square, division.point[i] + (kMaxCandidates - count), count, level, face,
                face);
  };
  add_front(0, of_first, first);
  add_front(1, of_second, second);
  add_front(2, of_third, third);
  Face facing = first + second + third;
  add_back(0, of_first, facing);
  add_back(1, of_second, second);
  add_back(2, of_third, third);
  return {{{first, second, third}}, facing};
}

}  // namespace tactree::core
