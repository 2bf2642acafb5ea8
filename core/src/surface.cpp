#include "tactree/core/surface.hpp"

#include "tactree/core/octree.hpp"

namespace tactree::core {
namespace {

// Offset of the centroid, in support radii, from which the strength falls and at which it is 0.
// On a regular sheet it is below 0.1 inside and 0.24 on the rim.
constexpr float kFadeBegins = 0.6F;
constexpr float kFadeEnds = 0.95F;

// Below this share of A the points are as good as one point: fit a plane.
constexpr float kFlatShare = 1e-3F;

/// The weighted sums of the fit; q counts from the query position.
struct Moments {
  float w = 0.0F;
  Vec3 p{};
  Vec3 n{};
  float a = 0.0F;
  float b = 0.0F;
};

Moments sum_moments(const CandidateSet& set, Vec3 x, float radius, Vec3 reference) {
  const float inverse_squared = 1.0F / (radius * radius);
  Moments m;
  for (std::uint32_t i = 0; i < set.count(); ++i) {  // bound: kMaxCandidates
    const Vec3 q = set.position(i) - x;
    const float qq = length_squared(q);
    const float u = 1.0F - qq * inverse_squared;
    const Vec3 n = set.normal(i);
    if (!(u > 0.0F) || !(dot(n, reference) > 0.0F)) {
      continue;
    }
    const float u2 = u * u;
    const float w = u2 * u2;
    m.w += w;
    m.p += w * q;
    m.n += w * n;
    m.a += w * qq;
    m.b += w * dot(q, n);
  }
  return m;
}

/// 1 below kFadeBegins, 0 from kFadeEnds on, smooth between.
float strength_of(float offset) {
  if (!(offset > kFadeBegins)) {
    return 1.0F;
  }
  if (!(offset < kFadeEnds)) {
    return 0.0F;
  }
  const float s = (kFadeEnds - offset) * (1.0F / (kFadeEnds - kFadeBegins));
  return s * s * (3.0F - 2.0F * s);
}

}  // namespace

void CandidateSet::cover(const BlobView& view, Vec3 x) {
  if (view.empty()) {
    count_ = 0;
    valid_ = false;
    return;
  }
  const float slack = view.reach_m() - view.header().support_radius_m;
  const bool inside = length_squared(x - centre_) <= slack * slack;
  if (!valid_ || !inside) {
    gather(view, x);
  }
}

void CandidateSet::gather(const BlobView& view, Vec3 centre) {
  count_ = 0;
  complete_ = true;
  centre_ = centre;
  valid_ = true;
  LeafSet found;
  find_leaves_within(view, centre, view.reach_m(), found);
  const float reach_squared = view.reach_m() * view.reach_m();
  for (std::uint32_t i = 0; i < found.count; ++i) {  // bound: kLeavesPerQuery
    gather_leaf(view, found.leaves[i], reach_squared);
  }
}

void CandidateSet::gather_leaf(const BlobView& view, const Leaf& leaf, float reach_squared) {
  const std::uint32_t end = leaf.first_point + leaf.point_count;
  for (std::uint32_t index = leaf.first_point; index < end;
       ++index) {  // bound: points_per_leaf_max
    const Vec3 position = view.position(leaf, index);
    if (!(length_squared(position - centre_) <= reach_squared)) {
      continue;
    }
    if (count_ == kMaxCandidates) {
      complete_ = false;
      return;
    }
    positions_[count_] = position;
    normals_[count_] = view.normal(index);
    points_[count_] = index;
    ++count_;
  }
}

std::uint32_t nearest_candidate(const CandidateSet& set, Vec3 x, float radius) {
  float best = radius * radius;
  std::uint32_t slot = kNoCandidate;
  for (std::uint32_t i = 0; i < set.count(); ++i) {  // bound: kMaxCandidates
    const float squared = length_squared(set.position(i) - x);
    if (squared < best) {
      best = squared;
      slot = i;
    }
  }
  return slot;
}

SurfaceFit fit_surface(const CandidateSet& set, Vec3 x, float radius, Vec3 reference) {
  const Moments m = sum_moments(set, x, radius, reference);
  SurfaceFit fit;
  if (!(m.w > 0.0F)) {
    return fit;
  }
  const float inverse_w = 1.0F / m.w;
  const float spread = m.a - dot(m.p, m.p) * inverse_w;
  float uq = 0.0F;
  if (spread > kFlatShare * m.a) {
    uq = 0.5F * (m.b - dot(m.p, m.n) * inverse_w) / spread;
  }
  const Vec3 l = inverse_w * (m.n - (2.0F * uq) * m.p);
  const float uc = -inverse_w * (dot(l, m.p) + uq * m.a);
  const float ll = length_squared(l);
  if (!(ll > 1e-12F) || !is_finite(ll) || !is_finite(uc)) {
    return fit;
  }
  const float l_length = square_root(ll);
  const float root = ll - 4.0F * uc * uq;
  const float distance = 2.0F * uc / (l_length + square_root(root > 0.0F ? root : 0.0F));
  const Vec3 normal = (1.0F / l_length) * l;

  const Vec3 centroid = inverse_w * m.p;
  const Vec3 along = centroid - dot(centroid, normal) * normal;
  const float strength = strength_of(length(along) / radius);
  if (!(strength > 0.0F) || !is_finite(distance)) {
    return fit;
  }
  return {true, distance, normal, strength};
}

SurfaceProjection project_to_surface(const BlobView& view, Vec3 x, CandidateSet& scratch) {
  SurfaceProjection result;
  if (surface_support(view) != SurfaceSupport::kOk || !is_finite(x)) {
    return result;
  }
  const float radius = view.header().support_radius_m;
  scratch.clear();
  scratch.cover(view, x);
  const std::uint32_t nearest = nearest_candidate(scratch, x, radius);
  if (nearest == kNoCandidate) {
    return result;
  }
  const SurfaceFit first = fit_surface(scratch, x, radius, scratch.normal(nearest));
  if (!first.supported) {
    return result;
  }
  const Vec3 near = x - first.distance * first.normal;
  scratch.cover(view, near);
  const SurfaceFit second = fit_surface(scratch, near, radius, first.normal);
  if (!second.supported) {
    return result;
  }
  result.supported = true;
  result.point = near - second.distance * second.normal;
  result.normal = second.normal;
  const float distance = length(x - result.point);
  result.signed_distance = first.distance < 0.0F ? -distance : distance;
  return result;
}

SurfaceProjection project_to_surface(const BlobView& view, Vec3 x) {
  CandidateSet scratch;
  return project_to_surface(view, x, scratch);
}

SurfaceSupport surface_support(const BlobView& view) {
  if (view.empty()) {
    return SurfaceSupport::kEmpty;
  }
  const float radius = view.header().support_radius_m;
  if (!(radius > 0.0F) || !(view.reach_m() >= radius)) {
    return SurfaceSupport::kNoReach;
  }
  if (view.header().points_per_ball_max > kMaxCandidates) {
    return SurfaceSupport::kTooManyPoints;
  }
  return SurfaceSupport::kOk;
}

}  // namespace tactree::core
