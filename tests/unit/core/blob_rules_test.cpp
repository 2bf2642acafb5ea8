// Rules of open_blob() that one changed word does not break: what several figures, in agreement
// with each other, could still hide.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "tactree/core/blob.hpp"
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

  [[nodiscard]] BlobStatus open() {
    builder::seal(bytes_);
    core::BlobView view;
    return core::open_blob(bytes_, view);
  }

  /// The word that tells the last leaves of the tree.
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

TEST_P(BlobRules, TheSpecimenIsAccepted) { EXPECT_EQ(blob.open(), BlobStatus::kOk); }

TEST_P(BlobRules, TheLastSectionEndsWithinTheBytes) {
  blob.resize(blob.size() - 4);
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, NothingFollowsTheLastSection) {
  blob.resize(blob.size() + 4);
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, ThePaddingOfTheLastSectionIsThere) {
  Specimen odd(GetParam(), 399);
  const std::uint32_t indices = odd.header().material_indices.bytes;
  ASSERT_NE(indices % 4U, 0U);
  ASSERT_EQ(odd.open(), BlobStatus::kOk);
  odd.resize(odd.header().material_indices.offset + indices);
  EXPECT_EQ(odd.open(), BlobStatus::kBadSections);
}

TEST_P(BlobRules, ALeafLessThanDeclaredIsNoticed) {
  std::uint32_t& leaves = blob.last_leaves();
  ASSERT_GT(std::popcount(leaves >> 24), 1);
  leaves &= ~std::bit_floor(leaves);
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST_P(BlobRules, ALeafMoreThanDeclaredIsNoticed) {
  std::uint32_t& leaves = blob.last_leaves();
  const std::uint32_t free = ~leaves & 0xFF000000U;
  ASSERT_NE(free, 0U);
  leaves |= std::bit_floor(free);
  EXPECT_EQ(blob.open(), BlobStatus::kBadTree);
}

TEST(BlobRules, ATreeDeeperThanDeclaredIsNoticed) {
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

TEST(BlobRules, ATreeLessDeepThanDeclaredIsNoticed) {
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

TEST(BlobRules, ASearchFromTheDirectoryIsNotTooLong) {
  Specimen blob(Profile::kSurface);
  blob.header().depth = core::kMaxDepth;
  blob.header().directory_level = 0;
  EXPECT_EQ(blob.open(), BlobStatus::kBadHeader);
}

TEST(BlobRules, VertexBoxesLieWithinTheReach) {
  Specimen blob(Profile::kSurface);
  blob.header().aabb_edge_m = 2.0F * blob.header().reach_m;
  EXPECT_EQ(blob.open(), BlobStatus::kOk);
  blob.header().aabb_edge_m = std::nextafter(2.0F * blob.header().reach_m, 1.0F);
  EXPECT_EQ(blob.open(), BlobStatus::kBadFigures);
}

TEST(BlobRules, NoNeighbourIsANodeAtTheLeavesLevel) {
  Specimen blob(Profile::kPaper);
  auto* neighbours = blob.items<std::uint32_t>(blob.header().neighbours);
  const std::uint32_t depth = blob.header().depth;
  neighbours[0] = core::kNeighbourIsNode | depth << core::kNeighbourLevelShift;
  EXPECT_EQ(blob.open(), BlobStatus::kBadNeighbours);
  neighbours[0] = core::kNeighbourIsNode | (depth - 1U) << core::kNeighbourLevelShift;
  EXPECT_EQ(blob.open(), BlobStatus::kOk);
}

// Where the leaves fill their last group, one more offset stands alone behind them.
TEST(BlobRules, TheOffsetBehindTheLastFullGroupIsZero) {
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
TEST(BlobRules, FiguresAreTakenUpToTheirEndsAndNoFurther) {
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

TEST(BlobRules, TheFirstLettersOfTheMagicCountToo) {
  for (std::size_t i = 0; i < 8; ++i) {
    Specimen blob(Profile::kSurface);
    blob.header().magic[i] ^= 1U;
    EXPECT_EQ(blob.open(), BlobStatus::kBadMagic) << i;
  }
}

TEST(BlobRules, TheFirstIndexAndBothReservedWordsOfAMaterialCount) {
  Specimen index(Profile::kSurface);
  index.items<std::uint8_t>(index.header().material_indices)[0] = 2;
  EXPECT_EQ(index.open(), BlobStatus::kBadMaterials);
  for (int word = 0; word < 2; ++word) {
    Specimen blob(Profile::kSurface);
    second_material(blob).reserved[word] = 1;
    EXPECT_EQ(blob.open(), BlobStatus::kBadMaterials) << word;
  }
}

TEST(BlobRules, EveryPointOfALeafIsComparedWithTheOneBefore) {
  Specimen blob(Profile::kSurface);
  auto* points = blob.items<std::uint32_t>(blob.header().points);
  const auto* offsets = blob.items<std::uint16_t>(blob.header().leaf_offsets);
  ASSERT_GE(offsets[1] - offsets[0], 3);
  points[2] = points[1];  // above the first, but not above the second
  EXPECT_EQ(blob.open(), BlobStatus::kBadPoints);
}

TEST(BlobRules, AHeaderFillsAtMostTheBlob) {
  Specimen blob(Profile::kSurface);
  blob.header().header_bytes = static_cast<std::uint32_t>(blob.size());
  EXPECT_EQ(blob.open(), BlobStatus::kBadSections);
  blob.header().header_bytes += 4;
  EXPECT_EQ(blob.open(), BlobStatus::kBadHeader);
}

TEST(BlobRules, CoordinatesStayWithinWhatAFloatHoldsExactly) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t low :
         {-core::kMaxCoordinate - 1, core::kMaxCoordinate - core::kLeafUnits + 1}) {
      Specimen blob(Profile::kPaper);
      blob.header().step_m = 0x1p-20F;
      blob.header().leaf_edge_min_m = 0x1p-20F * static_cast<float>(core::kLeafUnits);
      blob.header().root_min[axis] = low;
      blob.header().bounds_min_m[axis] = 0x1p-20F * static_cast<float>(low);
      blob.header().bounds_max_m[axis] = blob.header().bounds_min_m[axis];
      EXPECT_EQ(blob.open(), BlobStatus::kBadFigures) << axis << " " << low;
    }
  }
}

TEST(BlobRules, AStatusThatIsNoneHasWordsToo) {
  EXPECT_STREQ(core::describe(static_cast<BlobStatus>(200)), "unknown status");
}

}  // namespace
}  // namespace tactree
