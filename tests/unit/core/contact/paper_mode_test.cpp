// The paper's method, against an independent implementation of its text, and against its Table 1.

#include "tactree/core/contact/paper_mode.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "test_models.hpp"

namespace tactree::core {
namespace {

using test::TestBlob;

// An octree by the book: a map from (level, cell) to points, descended in double precision.
class ReferencePaper {
 public:
  explicit ReferencePaper(const TestBlob& blob) : blob_(blob) {
    const BlobView& view = blob.view();
    step_ = static_cast<double>(view.step_m());
    half_box_ = 0.5 * static_cast<double>(view.header().aabb_edge_m);
    for (LeafCursor cursor(view); !cursor.done(); cursor.next()) {
      leaves_[key(cursor.leaf().level, cursor.leaf().min)] = cursor.leaf();
    }
  }

  const Leaf* leaf_at(double x, double y, double z) const {
    const BlobHeader& header = blob_.view().header();
    for (std::uint32_t level = 1; level <= blob_.view().depth(); ++level) {
      const std::int64_t edge = std::int64_t{kLeafUnits} << (blob_.view().depth() - level);
      const auto corner = [&](double v, std::int32_t root) {
        const double cells = std::floor((std::floor(v / step_) - root) / static_cast<double>(edge));
        return static_cast<std::int32_t>(root + static_cast<std::int64_t>(cells) * edge);
      };
      const auto found =
          leaves_.find(key(level, {corner(x, header.root_min[0]), corner(y, header.root_min[1]),
                                   corner(z, header.root_min[2])}));
      if (found != leaves_.end()) return &found->second;
    }
    return nullptr;
  }

  std::vector<const Leaf*> six_point_leaves(Vec3 probe) const {
    const float s = blob_.view().header().six_point_offset_m;
    std::vector<const Leaf*> leaves;
    for (const Vec3 d : {Vec3{-s, 0, 0}, Vec3{s, 0, 0}, Vec3{0, -s, 0}, Vec3{0, s, 0},
                         Vec3{0, 0, -s}, Vec3{0, 0, s}}) {
      const Vec3 p = probe + d;
      leaves.push_back(
          leaf_at(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)));
    }
    return leaves;
  }

  const Leaf* own_leaf(Vec3 p) const {
    return leaf_at(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  }

  bool boxed(const Leaf* leaf, Vec3 probe) const {
    for (std::uint32_t i = 0; leaf != nullptr && i < leaf->point_count; ++i) {
      const Vec3 p = blob_.points()[leaf->first_point + i];
      if (std::abs(static_cast<double>(p.x) - static_cast<double>(probe.x)) <= half_box_ &&
          std::abs(static_cast<double>(p.y) - static_cast<double>(probe.y)) <= half_box_ &&
          std::abs(static_cast<double>(p.z) - static_cast<double>(probe.z)) <= half_box_) {
        return true;
      }
    }
    return false;
  }

  // The collision leaf, or null: no contact.
  const Leaf* collision(Vec3 probe) const {
    if (const Leaf* own = own_leaf(probe); boxed(own, probe)) return own;
    for (const Leaf* leaf : six_point_leaves(probe)) {
      if (boxed(leaf, probe)) return leaf;
    }
    return nullptr;
  }

  double nearest_distance(Vec3 probe, const Leaf* collision_leaf) const {
    std::vector<const Leaf*> leaves = six_point_leaves(probe);
    leaves.push_back(collision_leaf);
    double best = 1e30;
    for (const Leaf* leaf : leaves) {
      for (std::uint32_t i = 0; leaf != nullptr && i < leaf->point_count; ++i) {
        best = std::min(best,
                        static_cast<double>(length(blob_.points()[leaf->first_point + i] - probe)));
      }
    }
    return best;
  }

 private:
  using Key = std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::int32_t>;
  static Key key(std::uint32_t level, Int3 min) { return {level, min.x, min.y, min.z}; }

  const TestBlob& blob_;
  double step_;
  double half_box_;
  std::map<Key, Leaf> leaves_;
};

void compare_with_reference(const TestBlob& blob, std::uint32_t seed) {
  const ReferencePaper reference(blob);
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, blob.points().size() - 1);
  const float h = blob.view().header().spacing_m;
  std::uniform_real_distribution<float> offset(-1.5F * h, 1.5F * h);
  int contacts = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 probe = blob.points()[pick(random)];
    if (i % 50 != 0) probe += Vec3{offset(random), offset(random), offset(random)};
    const Leaf* const expected = reference.collision(probe);
    const PaperContact contact = paper_collision(blob.view(), probe);
    ASSERT_EQ(contact.in_contact, expected != nullptr);
    if (expected == nullptr) continue;
    ++contacts;
    ASSERT_EQ(contact.leaf.number, expected->number);
    const NearestPoint nearest = paper_nearest(blob.view(), probe, contact);
    ASSERT_TRUE(nearest.found());
    ASSERT_NEAR(std::sqrt(static_cast<double>(nearest.distance_squared)),
                reference.nearest_distance(probe, expected), 1e-6 * static_cast<double>(h));
  }
  EXPECT_GT(contacts, 2000);
}

TEST(PaperMode, MatchesReferenceOnSheet) {
  compare_with_reference(TestBlob(test::cos_sheet(0.1, 0.0025, Profile::kPaper)), 1);
}

TEST(PaperMode, MatchesReferenceOnUnevenCloud) {
  builder::Model model = test::random_cloud(3000, 0.2, 0.004, Profile::kPaper, 8);
  for (std::size_t i = 0; i < model.positions.size() / 2; ++i) model.positions[i] *= 0.2;
  compare_with_reference(TestBlob(model), 2);
}

TEST(PaperMode, MatchesReferenceInSurfaceBlob) {
  compare_with_reference(TestBlob(test::cos_sheet(0.1, 0.0025, Profile::kSurface)), 3);
}

// Table 1, row 0.0025: 6 820 probes on z = cos x + cos y, |x|, |y| <= 0.25 m, h = a = s = 0.0025.
// The paper found 106 false negatives and 1 false positive: 98.431 %.
TEST(PaperMode, ReproducesTable1AtFinestSeparation) {
  const TestBlob blob(test::cos_sheet(0.25, 0.0025, Profile::kPaper));
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-0.25, 0.25);
    int false_negatives = 0;
    for (int i = 0; i < 6820; ++i) {
      const double x = place(random);
      const double y = place(random);
      const Vec3 probe{static_cast<float>(x), static_cast<float>(y),
                       static_cast<float>(test::cos_sheet_height(x, y))};
      false_negatives += paper_collision(blob.view(), probe).in_contact ? 0 : 1;
    }
    EXPECT_GE(false_negatives, 85) << "seed " << seed;
    EXPECT_LE(false_negatives, 120) << "seed " << seed;
  }
}

// The exact query visits diagonal leaves too. What it still misses are the cracks between boxes of
// edge h whose points were rounded apart, by at most a quantisation step.
TEST(PaperMode, MissesMostlyInDiagonalLeaves) {
  const TestBlob blob(test::cos_sheet(0.25, 0.0025, Profile::kPaper));
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(-0.25, 0.25);
  int paper_misses = 0;
  int exact_misses = 0;
  for (int i = 0; i < 6820; ++i) {
    const double x = place(random);
    const double y = place(random);
    const Vec3 probe{static_cast<float>(x), static_cast<float>(y),
                     static_cast<float>(test::cos_sheet_height(x, y))};
    paper_misses += paper_collision(blob.view(), probe).in_contact ? 0 : 1;
    exact_misses += in_any_vertex_box(blob.view(), probe) ? 0 : 1;
  }
  EXPECT_LE(5 * exact_misses, paper_misses);
}

TEST(PaperMode, FindsNothingWithoutValidInput) {
  const TestBlob blob(test::sphere(0.03, 0.001));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(paper_collision({}, {}).in_contact);
  EXPECT_FALSE(paper_nearest({}, {}, {}).found());
  EXPECT_FALSE(paper_collision(blob.view(), {nan, 0.0F, 0.0F}).in_contact);
}

}  // namespace
}  // namespace tactree::core
