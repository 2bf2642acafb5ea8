// The passes over the candidates: sums over the points of one face, or of several.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "contact/passes.hpp"

namespace tactree::core {
namespace {

// A normal at 18 degrees or more from the reference may be that of another face. With 47 degrees, a
// groove of 150 degrees, whose normals differ by 30, would be rounded by 40 um.
constexpr float kMildCosine = 0.95F;

// The normals of a face's points are within 60 degrees of its seed. Points at more than 30 degrees
// lie between faces; if two seeds differ by less than 60 degrees, points at more than a quarter of
// that angle. Their weight tells a round surface, which stays one face, from a sharp edge.
constexpr float kFaceCosine = 0.5F;
constexpr float kBetweenCosine = 0.87F;

/// Weight of a point in the support at squared distance qq.
float weight_of(float qq, float inverse_squared) {
  const float u = 1.0F - qq * inverse_squared;
  const float u2 = u * u;
  return u2 * u2;
}

float larger_of(float a, float b) { return a > b ? a : b; }

/// Cosine of a quarter of the angle between two faces, if it is below 60 degrees; else 0.
float quarter_of(Vec3 a, Vec3 b) {
  const float cosine = dot(a, b);
  return cosine > kFaceCosine ? 1.0F - (1.0F - cosine) * (1.0F / 16.0F) : 0.0F;
}

struct ClosestSeed {
  float to_first;  // cosine of the angle to the first seed
  float cosine;    // to the closest one
  std::uint32_t number;
};
[[gnu::always_inline]] inline ClosestSeed closest_seed(Vec3 normal, Vec3 first, Vec3 second,
                                                       Vec3 third) {
  const float to_first = dot(normal, first);
  const float to_second = dot(normal, second);
  const float to_third = dot(normal, third);
  ClosestSeed closest{to_first, to_first, 0};
  if (to_second > closest.cosine) {
    closest.cosine = to_second;
    closest.number = 1;
  }
  if (to_third > closest.cosine) {
    closest.cosine = to_third;
    closest.number = 2;
  }
  return closest;
}

// A face has one level. A point has two heights above the query: along its own normal and along
// that of the face. Compared with the nearest point of the face, both differ by the distance
// between parallel faces, in the same direction. On a curved face and behind a bend they differ in
// opposite directions, and on a flat facet with the normals of a round surface, the second one
// hardly does. A point belongs to the face unless the product of the differences exceeds the square
// of this number of support radii. With a support of 2.5 spacings, stairs of one spacing differ by
// 0.4, and noise of 5 % of the spacing by 0.03 rms.
constexpr float kOtherLevel = 0.3F;

// Stairs have sharp edges. If more than one of this number of points lies between faces, the
// surface is rough or round, and faces keep all their points: on a scan of rough ground whose
// points were omitted, the force jumped by 0.18 N.
constexpr std::uint32_t kSharpRatio = 4;

/// Without those that do not face the reference of the first face.
[[gnu::always_inline]] inline std::uint32_t points_of_faces(const Division& division) {
  std::uint32_t points = division.facing[0];
  for (std::uint32_t i = 1; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    points += division.facing[i] + division.averted[i];
  }
  return points;
}

}  // namespace

[[gnu::noinline]] void add_to_face(const CandidateSet& points, Vec3 x, SupportSquare radius,
                                   const std::uint8_t* indices, std::uint32_t count,
                                   const Level& of_face, const Face& before, Face& after) {
  const float other_level = kOtherLevel * kOtherLevel * radius.squared;
  const Level level = of_face;
  Moments sums = before.sums;  // locals, which a compiler keeps in registers
  float between = before.between;
  std::uint32_t omitted = 0;
  // bound: points_per_support_max, total points_per_support_max per sum_faces
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t index = indices[k];
    const Candidate& candidate = points[index & ~std::uint32_t{Division::kBetween}];
    const Vec3 q = candidate.position - x;
    const float own = dot(q, candidate.normal) - level.own;
    const float common = dot(q, level.normal) - level.common;
    if (own * common > other_level) {
      ++omitted;
      continue;
    }
    const float qq = length_squared(q);
    const float weight = weight_of(qq, radius.inverse);
    sums.add(q, qq, candidate.normal, weight);
    between += (index & Division::kBetween) != 0U ? weight : 0.0F;
  }
  after = {sums, before.points + count - omitted, between};
}

// The sums are locals, not members of the result: a compiler keeps locals in registers. The first
// loop selects, so that a point outside the support costs little.
[[gnu::noinline]] Surroundings look_around(const CandidateSet& points, Vec3 x, float radius,
                                           Vec3 reference) {
  const float radius_squared = radius * radius;
  const float inverse_squared = 1.0F / radius_squared;
  std::uint8_t in_support[kMaxCandidates];
  std::uint32_t count = 0;
  bool complete = true;
  const std::uint32_t most = points.most_in_support();
  const std::uint32_t all = points.count();
  for (std::uint32_t i = 0; i < all; ++i) {  // bound: points_per_ball_max
    if (!(length_squared(points[i].position - x) < radius_squared)) {
      continue;
    }
    if (count == most) {
      complete = false;
      break;
    }
    in_support[count++] = static_cast<std::uint8_t>(i);
  }
  Moments face{};
  float averted = 0.0F;
  float closest = 0.0F;
  Nearest own{radius_squared, nullptr};
  Nearest crease{radius_squared, nullptr};
  Nearest mild{radius_squared, nullptr};
  Nearest opposite{radius_squared, nullptr};
  for (std::uint32_t k = 0; k < count; ++k) {  // bound: points_per_support_max
    const Candidate& candidate = points[in_support[k]];
    const Vec3 q = candidate.position - x;
    const float qq = length_squared(q);
    const float weight = weight_of(qq, inverse_squared);
    const float cosine = dot(candidate.normal, reference);
    if (cosine < kMildCosine) {
      if (cosine > kCreaseCosine) {
        mild.offer(candidate, qq);
      } else if (cosine > kOppositeCosine) {
        crease.offer(candidate, qq);
      } else {
        opposite.offer(candidate, qq);
      }
      if (!(cosine > 0.0F)) {
        averted += weight;
        continue;
      }
    } else {
      own.offer(candidate, qq);
      closest = larger_of(closest, cosine);
    }
    face.add(q, qq, candidate.normal, weight);
  }
  return {face, complete, averted, own.point, closest, crease.point, mild.point, opposite.point};
}

// A point outside the support costs little. The bound limits the others by their stores, which all
// points in the support reach.
[[gnu::noinline]] void divide(const CandidateSet& points, Vec3 x, float radius, const Seeds& seeds,
                              Division& division) {
  const Vec3 seed = seeds.normal[0];
  const Vec3 second_seed = seeds.normal[1];
  const Vec3 third_seed = seeds.count == kMaxFaces ? seeds.normal[2] : Vec3{};
  const float between =
      larger_of(larger_of(kBetweenCosine, quarter_of(seed, second_seed)),
                larger_of(quarter_of(second_seed, third_seed), quarter_of(third_seed, seed)));
  const float radius_squared = radius * radius;
  Nearest stray{radius_squared, nullptr};
  Nearest opposite{radius_squared, nullptr};
  for (std::uint32_t i = 0; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    division.facing[i] = 0;
    division.averted[i] = 0;
    division.nearest[i] = {radius_squared, nullptr};
  }
  auto room = static_cast<std::int32_t>(points.most_in_support());
  division.complete = true;
  std::uint32_t round = 0;  // points between faces
  const std::uint32_t all = points.count();
  for (std::uint32_t i = 0; i < all; ++i) {  // bound: points_per_ball_max
    const Candidate& candidate = points[i];
    const float qq = length_squared(candidate.position - x);
    if (!(qq < radius_squared)) {
      continue;
    }
    if (--room < 0) {
      division.complete = false;
      break;
    }
    const auto [to_first, closer, face] =
        closest_seed(candidate.normal, seed, second_seed, third_seed);
    if (closer < kCreaseCosine) {
      (to_first > kOppositeCosine ? stray : opposite).offer(candidate, qq);
      if (!(closer > kFaceCosine)) {
        // A point that does not face the reference, either, is overwritten.
        const std::uint32_t place =
            to_first > 0.0F ? kMaxCandidates - ++division.averted[0] : division.facing[0];
        // at most: points_per_support_max per divide together support
        division.point[0][place] = static_cast<std::uint8_t>(i);
        continue;
      }
    }
    std::uint32_t flag = 0;
    if (closer < between) {
      flag = Division::kBetween;
      ++round;
    } else {
      division.nearest[face].offer(candidate, qq);
    }
    const std::uint32_t place =
        to_first > 0.0F ? division.facing[face]++ : kMaxCandidates - ++division.averted[face];
    // at most: points_per_support_max per divide together support
    division.point[face][place] = static_cast<std::uint8_t>(i | flag);
  }
  division.has_levels = round * kSharpRatio <= points_of_faces(division);
  division.stray = stray.point;
  division.opposite = opposite.point;
}

}  // namespace tactree::core
