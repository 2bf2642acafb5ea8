// Rules of open_blob() that one changed word does not break: what several figures, in agreement
// with each other, could still hide.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <vector>

#include "tactree/core/model/blob.hpp"
#include "test_models.hpp"

namespace tactree {
namespace {

using core::BlobHeader;
using core::BlobNode;
using core::BlobStatus;
using core::Profile;

/// A blob that is taken apart: its header, and its words by section.
class Specimen {
 public:
  explicit Specimen(Profile profile, std::size_t points = 400)
      : Specimen(test::cos_sheet(0.025, 0.0025, profile), points) {}
  Specimen(builder::Model model, std::size_t points) {
    model.positions.resize(points);
    model.normals.resize(points);
    model.materials.assign(2, {800.0F, 1.0F, 0.5F, 0.3F, 0.0F, 0.0F, {}});
    model.material_indices.assign(points, 1);
    bytes_ = builder::write_blob(model).bytes;
  }

  [[nodiscard]] BlobHeader& header() { return *reinterpret_cast<BlobHeader*>(bytes_.data()); }
  template <class T>
  [[nodiscard]] T* items(const core::BlobSection& section) {
    return reinterpret_cast<T*>(bytes_.data() + section.offset);
  }
  void resize(std::size_t size) {
    bytes_.resize(size);
    header().total_bytes = static_cast<std::uint32_t>(size);
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  /// Room for more nodes behind the last one.
  void insert_nodes(std::uint32_t bytes) {
    const std::uint32_t end = header().nodes.offset + header().nodes.bytes;
    bytes_.insert(bytes_.begin() + end, bytes, std::byte{0});
    BlobHeader& h = header();
    h.nodes.bytes += bytes;
    for (core::BlobSection* section :
         {&h.directory, &h.leaf_bases, &h.leaf_offsets, &h.points, &h.normals, &h.neighbours,
          &h.materials, &h.material_indices}) {
      section->offset += bytes;
    }
    h.total_bytes += bytes;
  }

  [[nodiscard]] BlobStatus open(core::BlobView& view) {
    builder::seal(bytes_);
    return core::open_blob(bytes_, view);
  }
  [[nodiscard]] BlobStatus open() {
    core::BlobView view;
    return open(view);
  }

  /// The word of the last group of leaves.
  [[nodiscard]] std::uint32_t& last_leaves() {
    const bool paper = header().profile == static_cast<std::uint32_t>(Profile::kPaper);
    auto* words = items<std::uint32_t>(header().nodes);
    const std::uint32_t count = header().nodes.bytes / 4U;
    for (std::uint32_t i = paper ? 1 : 0; i < count; i += paper ? 2 : 1) {
      const auto leaves = static_cast<std::uint32_t>(std::popcount(words[i] >> 24));
      const bool of_leaves = paper || i >= header().node_count / 2;
      if (of_leaves && leaves > 0 && (words[i] & 0xFFFFFFU) + leaves == header().leaf_count) {
        return words[i];
      }
    }
    ADD_FAILURE() << "the tree has no last leaves";
    return words[0];
  }

 private:
  std::vector<std::byte> bytes_;
};

class BlobRules : public testing::TestWithParam<Profile> {
 protected:
  Specimen blob{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Profiles, BlobRules, testing::Values(Profile::kSurface, Profile::kPaper));

TEST_P(BlobRules, AcceptsSpecimen) { EXPECT_EQ(blob.open(), BlobStatus::kOk); }

TEST_P(BlobRules, RefusesTruncatedLastSection) {
  blob.resize(blob.size() - 4);
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, RefusesBytesBehindLastSection) {
  blob.resize(blob.size() + 4);
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, RequiresPaddingOfLastSection) {
  Specimen odd(GetParam(), 399);
  const std::uint32_t indices = odd.header().material_indices.bytes;
  ASSERT_NE(indices % 4U, 0U);
  ASSERT_EQ(odd.open(), BlobStatus::kOk);
  odd.resize(odd.header().material_indices.offset + indices);
  EXPECT_EQ(odd.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, RefusesFewerLeavesThanDeclared) {
  std::uint32_t& leaves = blob.last_leaves();
  ASSERT_GT(std::popcount(leaves >> 24), 1);
  leaves &= ~std::bit_floor(leaves);
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST_P(BlobRules, RefusesMoreLeavesThanDeclared) {
  std::uint32_t& leaves = blob.last_leaves();
  const std::uint32_t free = ~leaves & 0xFF000000U;
  ASSERT_NE(free, 0U);
  leaves |= std::bit_floor(free);
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, RefusesTreeDeeperThanDeclared) {
  Specimen blob(Profile::kPaper);
  BlobHeader& h = blob.header();
  ASSERT_GT(h.depth, 1U);
  --h.depth;
  for (int axis = 0; axis < 3; ++axis) {  // a root of half the edge
    h.bounds_min_m[axis] = h.step_m * static_cast<float>(h.root_min[axis]);
    h.bounds_max_m[axis] = h.bounds_min_m[axis];
  }
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, RefusesTreeShallowerThanDeclared) {
  Specimen blob(Profile::kPaper);
  BlobHeader& h = blob.header();
  ++h.depth;
  // A root of twice the edge: the step is a power of two, so that it is exact anywhere.
  h.step_m = std::exp2(std::floor(std::log2(h.step_m)));
  h.leaf_edge_min_m = h.step_m * static_cast<float>(core::kLeafUnits);
  h.reach_m = 0.0F;
  for (int axis = 0; axis < 3; ++axis) {
    h.bounds_min_m[axis] = h.step_m * static_cast<float>(h.root_min[axis]);
    h.bounds_max_m[axis] = h.bounds_min_m[axis];
  }
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, LimitsLevelsBelowDirectory) {
  Specimen blob(Profile::kSurface);
  blob.header().depth = core::kMaxDepth;
  blob.header().directory_level = 0;
  EXPECT_EQ(blob.open(), BlobStatus::kBadHeader);
}

TEST(BlobRules, LimitsVertexBoxesToReach) {
  Specimen blob(Profile::kSurface);
  blob.header().aabb_edge_m = 2.0F * blob.header().reach_m;
  EXPECT_EQ(blob.open(), BlobStatus::kOk);
  blob.header().aabb_edge_m = std::nextafter(2.0F * blob.header().reach_m, 1.0F);
  EXPECT_EQ(blob.open(), BlobStatus::kBadFigures);
}

TEST(BlobRules, RefusesNeighbourNodeAmongLeaves) {
  Specimen blob(Profile::kPaper);
  auto* neighbours = blob.items<std::uint32_t>(blob.header().neighbours);
  const std::uint32_t depth = blob.header().depth;
  neighbours[0] = core::kNeighbourIsNode | depth << core::kNeighbourLevelShift;
  EXPECT_EQ(blob.open(), BlobStatus::kBadNeighbours);
  neighbours[0] = core::kNeighbourIsNode | (depth - 1U) << core::kNeighbourLevelShift;
  EXPECT_EQ(blob.open(), BlobStatus::kOk);
}

// Where the leaves fill their last group, one more offset stands alone behind them.
TEST(BlobRules, ChecksOffsetBehindLastGroup) {
  for (std::size_t points = 1; points < 400; ++points) {
    Specimen blob(test::random_cloud(400, 0.05, 0.002, Profile::kSurface, 3), points);
    const BlobHeader& h = blob.header();
    if ((h.leaf_count & ((1U << h.leaf_group_shift) - 1U)) != 0U) {
      continue;
    }
    ASSERT_EQ(blob.open(), BlobStatus::kOk);
    ++blob.items<std::uint16_t>(h.leaf_offsets)[h.leaf_count];
    --blob.items<std::uint32_t>(h.leaf_bases)[h.leaf_count >> h.leaf_group_shift];
    EXPECT_EQ(blob.open(), BlobStatus::kBadLeaves);
    return;
  }
  ADD_FAILURE() << "no model fills its last group";
}

struct Figure {
  const char* name;
  std::function<float*(Specimen&)> at;
  float low;
  float high;
  BlobStatus refused;
};

core::BlobMaterial& second_material(Specimen& blob) {
  return blob.items<core::BlobMaterial>(blob.header().materials)[1];
}

// Each end of each range is accepted, the next float beyond it is not.
TEST(BlobRules, AcceptsFiguresWithinRangeOnly) {
  const BlobStatus figures = BlobStatus::kBadFigures;
  const BlobStatus materials = BlobStatus::kBadMaterials;
  const Figure cases[] = {
      {"spacing", [](Specimen& b) { return &b.header().spacing_m; }, 0.0F, 1e9F, figures},
      {"support", [](Specimen& b) { return &b.header().support_radius_m; }, 0.0F, 1e9F, figures},
      {"aabb", [](Specimen& b) { return &b.header().aabb_edge_m; }, 0.0F, 1e9F, figures},
      {"offset", [](Specimen& b) { return &b.header().six_point_offset_m; }, 0.0F, 1e9F, figures},
      {"gap", [](Specimen& b) { return &b.header().largest_gap_m; }, 0.0F, 1e9F, figures},
      {"stiffness", [](Specimen& b) { return &second_material(b).stiffness_N_m; }, 0.0F, 1e6F,
       materials},
      {"damping", [](Specimen& b) { return &second_material(b).damping_Ns_m; }, 0.0F, 1e4F,
       materials},
      {"static", [](Specimen& b) { return &second_material(b).static_friction; }, 0.3F, 4.0F,
       materials},
      {"dynamic", [](Specimen& b) { return &second_material(b).dynamic_friction; }, 0.0F, 0.5F,
       materials},
      {"texture", [](Specimen& b) { return &second_material(b).texture_height_m; }, 0.0F, 1.0F,
       materials},
      {"wavelength", [](Specimen& b) { return &second_material(b).texture_wavelength_m; }, 0.0F,
       1e3F, materials},
  };
  for (const Figure& figure : cases) {
    const auto with = [&](float value) {
      Specimen blob(Profile::kPaper);
      *figure.at(blob) = value;
      return blob.open();
    };
    Specimen untouched(Profile::kPaper);
    const float low =
        figure.name[0] == 's' && figure.name[1] == 'p' ? untouched.header().step_m : figure.low;
    EXPECT_EQ(with(low), BlobStatus::kOk) << figure.name;
    EXPECT_EQ(with(figure.high), BlobStatus::kOk) << figure.name;
    EXPECT_EQ(with(std::nextafter(low, -1.0F)), figure.refused) << figure.name;
    EXPECT_EQ(with(std::nextafter(figure.high, 1e30F)), figure.refused) << figure.name;
  }
}

TEST(BlobRules, ComparesEveryMagicByte) {
  for (std::size_t i = 0; i < 8; ++i) {
    Specimen blob(Profile::kSurface);
    blob.header().magic[i] ^= 1U;
    EXPECT_EQ(blob.open(), BlobStatus::kBadMagic) << i;
  }
}

TEST(BlobRules, ChecksReservedWordsAndIndices) {
  Specimen index(Profile::kSurface);
  index.items<std::uint8_t>(index.header().material_indices)[0] = 2;
  EXPECT_EQ(index.open(), BlobStatus::kBadMaterials);
  for (int word = 0; word < 2; ++word) {
    Specimen blob(Profile::kSurface);
    second_material(blob).reserved[word] = 1;
    EXPECT_EQ(blob.open(), BlobStatus::kBadMaterials) << word;
  }
}

TEST(BlobRules, RequiresAscendingPointsInLeaf) {
  Specimen blob(Profile::kSurface);
  auto* points = blob.items<std::uint32_t>(blob.header().points);
  const auto* offsets = blob.items<std::uint16_t>(blob.header().leaf_offsets);
  ASSERT_GE(offsets[1] - offsets[0], 3);
  points[2] = points[1];  // above the first, but not above the second
  EXPECT_EQ(blob.open(), BlobStatus::kBadPoints);
}

TEST(BlobRules, RefusesHeaderLongerThanBlob) {
  Specimen blob(Profile::kSurface);
  blob.header().header_bytes = static_cast<std::uint32_t>(blob.size());
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
  blob.header().header_bytes += 4;
  EXPECT_EQ(blob.open(), BlobStatus::kBadHeader);
}

/// A paper blob whose figures fit any step and root: what is left are the rules of the lattice.
BlobStatus with_lattice(float step_m, std::int32_t low, int axis = 0) {
  Specimen blob(Profile::kPaper);
  BlobHeader& h = blob.header();
  h.step_m = step_m;
  h.leaf_edge_min_m = step_m * static_cast<float>(core::kLeafUnits);
  h.reach_m = 0.0F;
  h.spacing_m = 1e8F;
  for (int i = 0; i < 3; ++i) {
    h.root_min[i] = i == axis ? low : 0;
    h.bounds_min_m[i] = step_m * static_cast<float>(h.root_min[i]);
    h.bounds_max_m[i] = h.bounds_min_m[i];
  }
  return blob.open();
}
std::int32_t root_edge() { return core::kLeafUnits << Specimen(Profile::kPaper).header().depth; }

TEST(BlobRules, LimitsCoordinates) {
  const float step = 0x1p-20F;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t highest = core::kMaxCoordinate - root_edge();
    EXPECT_EQ(with_lattice(step, -core::kMaxCoordinate, axis), BlobStatus::kOk);
    EXPECT_EQ(with_lattice(step, -core::kMaxCoordinate - 1, axis), BlobStatus::kBadFigures);
    EXPECT_EQ(with_lattice(step, highest, axis), BlobStatus::kOk);
    EXPECT_EQ(with_lattice(step, highest + 1, axis), BlobStatus::kBadFigures);
  }
}

// The more significant bits a step has, the fewer are left for the integer.
TEST(BlobRules, LimitsCoordinatesToExactFloats) {
  const float step = 1.25F * 0x1p-20F;  // three bits
  constexpr std::int32_t kLargest = 1 << 21;
  EXPECT_EQ(with_lattice(step, -kLargest), BlobStatus::kOk);
  EXPECT_EQ(with_lattice(step, -kLargest - 1), BlobStatus::kBadFigures);
  EXPECT_EQ(with_lattice(step, kLargest - root_edge()), BlobStatus::kOk);
  EXPECT_EQ(with_lattice(step, kLargest - root_edge() + 1), BlobStatus::kBadFigures);
  // As many bits as leave just the root's edge.
  const int bits = 24 - std::countr_zero(static_cast<std::uint32_t>(root_edge()));
  const float fine = 0x1p-20F * (1.0F + std::ldexp(1.0F, 1 - bits));
  EXPECT_EQ(with_lattice(fine, 0), BlobStatus::kOk);
  EXPECT_EQ(with_lattice(fine, 1), BlobStatus::kBadFigures);
}

TEST(BlobRules, LimitsStep) {
  EXPECT_EQ(with_lattice(0x1p-39F, 0), BlobStatus::kOk);
  EXPECT_EQ(with_lattice(0x1p-40F, 0), BlobStatus::kBadFigures);  // 9e-13 m
  EXPECT_EQ(with_lattice(0x1p19F, 0), BlobStatus::kOk);
  EXPECT_EQ(with_lattice(0x1p20F, 0), BlobStatus::kBadFigures);  // 1.05e6 m
}

TEST(BlobRules, RefusesHeaderWithoutSections) {
  Specimen blob(Profile::kSurface);
  blob.resize(sizeof(BlobHeader));
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST(BlobRules, AcceptsCountsAtLimits) {
  Specimen blob(Profile::kPaper);
  blob.header().leaf_count = core::kMaxLeaves;
  blob.header().point_count = core::kMaxLeaves;
  blob.header().node_count = core::kMaxNodes;
  blob.header().material_count = core::kMaxMaterials;
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST(BlobRules, AcceptsDepthsAtLimits) {
  Specimen paper(Profile::kPaper);
  paper.header().depth = core::kMaxDepth;
  EXPECT_NE(paper.open(), BlobStatus::kBadHeader);
  Specimen surface(Profile::kSurface);
  surface.header().depth = core::kMaxDepth;
  surface.header().directory_level = core::kMaxDepth - core::kMaxLevelsBelow;
  EXPECT_NE(surface.open(), BlobStatus::kBadHeader);
}

TEST(BlobRules, RequiresQueryToHoldLeaf) {
  Specimen blob(Profile::kSurface);
  blob.header().points_per_slab_max = 1;
  EXPECT_EQ(blob.open(), BlobStatus::kOk);
  blob.header().points_per_query_max = blob.header().points_per_leaf_max - 1U;
  EXPECT_EQ(blob.open(), BlobStatus::kBadHeader);
}

TEST(BlobRules, RequiresSupportInSurfaceProfile) {
  Specimen blob(Profile::kSurface);
  blob.header().support_radius_m = 0.0F;
  EXPECT_EQ(blob.open(), BlobStatus::kBadFigures);
}

// Sizes that agree with the counts, of far more than there is: not even padding is read.
TEST(BlobRules, RefusesSectionsFarBeyondBytes) {
  Specimen blob(Profile::kSurface);
  BlobHeader& h = blob.header();
  h.point_count = 0x2FFFFFFFU;  // odd: its normals are padded
  h.points.bytes = 4U * h.point_count;
  h.normals.offset = h.points.offset + h.points.bytes;
  h.normals.bytes = 2U * h.point_count;
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST(BlobRules, OmitsIndicesOfSingleMaterial) {
  builder::Model model = test::cos_sheet(0.025, 0.0025, Profile::kSurface);
  model.materials.assign(1, {800.0F, 1.0F, 0.5F, 0.3F, 0.0F, 0.0F, {}});
  const std::vector<std::byte> bytes = builder::write_blob(model).bytes;
  core::BlobView view;
  ASSERT_EQ(core::open_blob(bytes, view), BlobStatus::kOk);
  EXPECT_EQ(view.header().material_indices.bytes, 0U);
  EXPECT_EQ(view.material_of(view.point_count() - 1U), 0U);
}

TEST_P(BlobRules, ReturnsHeaderValuesInView) {
  core::BlobView view;
  ASSERT_EQ(blob.open(view), BlobStatus::kOk);
  const BlobHeader& h = blob.header();
  EXPECT_EQ(view.support_radius_m(), h.support_radius_m);
  EXPECT_EQ(view.reach_m(), h.reach_m);
  EXPECT_EQ(view.cells_and_one(), static_cast<float>((1U << h.depth) + 1U));
  EXPECT_EQ(view.root_min(), (core::Int3{h.root_min[0], h.root_min[1], h.root_min[2]}));
  EXPECT_EQ(view.node_count(), h.node_count);
  EXPECT_EQ(view.leaf_count(), h.leaf_count);
  EXPECT_EQ(view.point_count(), h.point_count);
  EXPECT_EQ(view.material_count(), h.material_count);
}

// First points that are right, of a base that is not the group's first point.
TEST(BlobRules, RequiresLeafGroupAtBase) {
  Specimen blob(test::cos_sheet(0.1, 0.0025, Profile::kSurface), 6000);
  const BlobHeader& h = blob.header();
  const std::uint32_t in_group = 1U << h.leaf_group_shift;
  ASSERT_GT(h.leaf_count, 2U * in_group);
  --blob.items<std::uint32_t>(h.leaf_bases)[1];
  for (std::uint32_t i = in_group; i < 2U * in_group; ++i) {
    ++blob.items<std::uint16_t>(h.leaf_offsets)[i];
  }
  EXPECT_EQ(blob.open(), BlobStatus::kBadLeaves);
}

// Each node the only child of the one before.
TEST(BlobRules, RefusesEndlessNodeChain) {
  Specimen blob(test::cos_sheet(0.1, 0.0025, Profile::kPaper), 6000);
  const std::uint32_t count = blob.header().node_count;
  ASSERT_GT(count, 300U);
  for (std::uint32_t i = 0; i < count; ++i) {
    blob.items<BlobNode>(blob.header().nodes)[i] = {1U << 24 | (i + 1U), 0U};
  }
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, RefusesAmbiguousOctant) {
  Specimen blob(Profile::kPaper);
  auto* nodes = blob.items<BlobNode>(blob.header().nodes);
  for (std::uint32_t i = 0; i < blob.header().node_count; ++i) {
    if (nodes[i].nodes >> 24 != 0U && nodes[i].leaves >> 24 != 0U) {
      // Its last leaf where it has a node, so that no number changes.
      nodes[i].leaves &= ~std::bit_floor(nodes[i].leaves);
      nodes[i].leaves |= std::bit_floor(nodes[i].nodes);
      EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
      return;
    }
  }
  ADD_FAILURE() << "no node has children of both kinds";
}

// One more child of the last node that has nodes below it, in an octant that was empty.
TEST(BlobRules, RefusesNodeWithoutChildren) {
  Specimen blob(Profile::kPaper);
  const std::uint32_t count = blob.header().node_count;
  blob.insert_nodes(sizeof(BlobNode));
  auto* nodes = blob.items<BlobNode>(blob.header().nodes);
  std::uint32_t parent = 0;
  const auto is_last = [&](const BlobNode& node) {
    const auto children = static_cast<std::uint32_t>(std::popcount(node.nodes >> 24));
    return children != 0U && (node.nodes & 0xFFFFFFU) + children == count;
  };
  while (parent < count && !is_last(nodes[parent])) {
    ++parent;
  }
  ASSERT_LT(parent, count);
  const std::uint32_t free = ~(nodes[parent].nodes | nodes[parent].leaves) & 0xFF000000U;
  ASSERT_NE(free, 0U);
  const std::uint32_t octant = std::bit_floor(free);
  const auto below =
      static_cast<std::uint32_t>(std::popcount(nodes[parent].nodes & (octant - 1U) & 0xFF000000U));
  const std::uint32_t child = (nodes[parent].nodes & 0xFFFFFFU) + below;
  std::copy_backward(nodes + child, nodes + count, nodes + count + 1);
  nodes[parent].nodes |= octant;
  blob.header().node_count = count + 1U;
  nodes[child] = {(1U << 24) | (count + 1U), 0U};  // a node that is not there
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
  nodes[child] = {0U, 0U};
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, CountsNeighboursFromZero) {
  for (const bool is_node : {true, false}) {
    Specimen blob(Profile::kPaper);
    const BlobHeader& h = blob.header();
    auto* neighbours = blob.items<std::uint32_t>(h.neighbours);
    const std::uint32_t count = is_node ? h.node_count : h.leaf_count;
    const std::uint32_t kind = is_node ? core::kNeighbourIsNode : 0U;
    neighbours[0] = kind | (count - 1U);
    EXPECT_EQ(blob.open(), BlobStatus::kOk);
    neighbours[0] = kind | count;
    EXPECT_EQ(blob.open(), BlobStatus::kBadNeighbours);
  }
}

TEST(BlobRules, DescribesUnknownStatus) {
  EXPECT_STREQ(core::describe(static_cast<BlobStatus>(200)), "unknown status");
}

}  // namespace
}  // namespace tactree
