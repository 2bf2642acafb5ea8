// The golden blobs open, and every query on them equals a search of all points and the result on
// other processors, to the bit.

#include <cstdint>
#include <span>

#include "check.hpp"
#include "golden_blobs.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/nearest.hpp"

namespace tactree::test {
namespace {

using core::BlobView;
using core::Vec3;

constexpr std::uint32_t kPointsMax = 600;
Vec3 points[kPointsMax];

core::BlobView open(Golden which) {
  BlobView view;
  TACTREE_CHECK(core::open_blob(golden(which), view) == core::BlobStatus::kOk);
  TACTREE_CHECK(view.point_count() > 100 && view.point_count() <= kPointsMax);
  std::uint32_t count = 0;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count && count < kPointsMax; ++i) {
      points[count++] = view.position(leaf, leaf.first_point + i);
    }
  }
  TACTREE_CHECK(count == view.point_count());
  return view;
}

Vec3 probe_near(const BlobView& view, Numbers& numbers) {
  const core::BlobHeader& h = view.header();
  const float margin = 2.0F * view.reach_m();
  Vec3 probe;
  probe.x = numbers.between(h.bounds_min_m[0] - margin, h.bounds_max_m[0] + margin);
  probe.y = numbers.between(h.bounds_min_m[1] - margin, h.bounds_max_m[1] + margin);
  probe.z = numbers.between(h.bounds_min_m[2] - margin, h.bounds_max_m[2] + margin);
  return probe;
}

struct BruteForce {
  std::uint32_t nearest = core::kNoPoint;
  bool in_box = false;
};

BruteForce look_at_all(const BlobView& view, Vec3 probe) {
  const float reach_squared = view.reach_m() * view.reach_m();
  const float half_edge = 0.5F * view.header().aabb_edge_m;
  float best = reach_squared;
  BruteForce found;
  for (std::uint32_t i = 0; i < view.point_count(); ++i) {
    const Vec3 d = probe - points[i];
    const float squared = core::length_squared(d);
    if (squared < best || (squared == best && found.nearest == core::kNoPoint)) {
      best = squared;
      found.nearest = i;
    }
    found.in_box =
        found.in_box || (core::absolute(d.x) <= half_edge && core::absolute(d.y) <= half_edge &&
                         core::absolute(d.z) <= half_edge);
  }
  return found;
}

void add(core::Crc32& crc, Vec3 v) { crc.update(std::as_bytes(std::span(&v, 1))); }

std::uint32_t exact_queries(const BlobView& view) {
  Numbers numbers(7);
  core::Crc32 crc;
  std::uint32_t hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 probe = probe_near(view, numbers);
    const BruteForce expected = look_at_all(view, probe);
    const core::NearestPoint nearest = core::nearest_within(view, probe, view.reach_m());
    TACTREE_CHECK(nearest.index == expected.nearest);
    if (0.5F * view.header().aabb_edge_m <= view.reach_m()) {
      TACTREE_CHECK(core::in_any_vertex_box(view, probe) == expected.in_box);
    }
    hits += nearest.found() ? 1U : 0U;
    crc.update(std::as_bytes(std::span(&nearest.distance_squared, 1)));
    add(crc, nearest.position);
  }
  TACTREE_CHECK(hits > 100 && hits < 1000);
  return crc.value();
}

std::uint32_t projections(const BlobView& view) {
  static core::CandidateSet scratch;
  Numbers numbers(8);
  core::Crc32 crc;
  std::uint32_t supported = 0;
  for (int i = 0; i < 500; ++i) {
    const core::SurfaceProjection p =
        core::project_to_surface(view, probe_near(view, numbers), scratch);
    supported += p.supported ? 1U : 0U;
    add(crc, p.point);
    add(crc, p.normal);
    crc.update(std::as_bytes(std::span(&p.signed_distance, 1)));
  }
  TACTREE_CHECK(supported > 50);
  return crc.value();
}

std::uint32_t paper_contacts(const BlobView& view) {
  Numbers numbers(9);
  core::Crc32 crc;
  std::uint32_t contacts = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 probe = probe_near(view, numbers);
    const core::PaperContact contact = core::paper_collision(view, probe);
    if (contact.in_contact) {
      ++contacts;
      const auto nearest = core::paper_nearest(view, probe, contact);
      add(crc, nearest.position);
    }
  }
  TACTREE_CHECK(contacts > 20);
  return crc.value();
}

}  // namespace

void test_golden_blobs() {
  const BlobView surface = open(Golden::kSurface);
  TACTREE_CHECK(core::surface_support(surface) == core::SurfaceSupport::kOk);
  TACTREE_CHECK_ANSWER(exact_queries(surface), 0xF51F10ECU);
  TACTREE_CHECK_ANSWER(projections(surface), 0x12EA0C18U);
  const BlobView paper = open(Golden::kPaper);
  TACTREE_CHECK_ANSWER(exact_queries(paper), 0x338C3B01U);
  TACTREE_CHECK_ANSWER(paper_contacts(paper), 0x9B41F5B0U);
}

}  // namespace tactree::test
