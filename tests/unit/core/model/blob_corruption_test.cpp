// Bytes from outside: what open_blob() refuses, and what holds for everything it accepts.
// The suite seals the checksum again after each corruption, so that the structural checks are
// reached; blobs stand at the very end of their allocation, so that a sanitizer sees a byte too
// far.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <random>

#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/model/nearest.hpp"
#include "test_models.hpp"

namespace tactree {
namespace {

using core::BlobHeader;
using core::BlobStatus;
using core::BlobView;
using core::Profile;
using Bytes = std::vector<std::byte>;

// An exact-size, 4-byte aligned copy.
class ExactBuffer {
 public:
  explicit ExactBuffer(std::span<const std::byte> bytes)
      : size_(bytes.size()), data_(new std::byte[size_]) {
    std::copy(bytes.begin(), bytes.end(), data_.get());
  }
  [[nodiscard]] std::span<const std::byte> span() const { return {data_.get(), size_}; }

 private:
  std::size_t size_;
  std::unique_ptr<std::byte[]> data_;
};

BlobStatus open(const Bytes& bytes) {
  const ExactBuffer buffer(bytes);
  BlobView view;
  const BlobStatus status = core::open_blob(buffer.span(), view);
  EXPECT_EQ(view.empty(), status != BlobStatus::kOk);
  return status;
}

Bytes golden(Profile profile) {
  builder::Model model = test::cos_sheet(0.025, 0.0025, profile);
  model.name = "golden";
  model.materials = {{800.0F, 1.0F, 0.5F, 0.3F, 0.0F, 0.0F, {}},
                     {200.0F, 0.5F, 0.1F, 0.1F, 0.0F, 0.0F, {}}};
  model.material_indices.assign(model.positions.size(), 1);
  return builder::write_blob(model).bytes;
}

BlobHeader header_of(const Bytes& bytes) {
  BlobHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

// Everything a query does, on a blob that was accepted.
void use(const BlobView& view, std::uint32_t seed) {
  std::mt19937 random(seed);
  const float extent = view.step_m() * static_cast<float>(core::kLeafUnits << view.depth());
  std::uniform_real_distribution<float> place(-extent, extent);
  for (int i = 0; i < 16; ++i) {
    const core::Vec3 probe{place(random), place(random), place(random)};
    (void)core::nearest_within(view, probe, view.reach_m());
    (void)core::in_any_vertex_box(view, probe);
    core::PaperContact contact = core::paper_collision(view, probe);
    core::LeafCursor first(view);
    contact.in_contact = true;
    if (contact.leaf.point_count == 0) contact.leaf = first.leaf();
    (void)core::paper_nearest(view, probe, contact);
  }
  std::uint64_t points = 0;
  std::uint64_t leaves = 0;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    ASSERT_EQ(cursor.leaf().number, leaves++);
    for (std::uint32_t p = 0; p < cursor.leaf().point_count; ++p) {
      ASSERT_TRUE(core::is_finite(view.position(cursor.leaf(), cursor.leaf().first_point + p)));
      (void)view.material_of(cursor.leaf().first_point + p);
    }
    points += cursor.leaf().point_count;
  }
  ASSERT_EQ(points, view.point_count());
}

class Corruption : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, Corruption, testing::Values(Profile::kSurface, Profile::kPaper));

TEST_P(Corruption, AcceptsGoldenBlob) { EXPECT_EQ(open(golden(GetParam())), BlobStatus::kOk); }

TEST_P(Corruption, RefusesEveryPrefix) {
  const Bytes whole = golden(GetParam());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_EQ(open(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
              size < sizeof(BlobHeader) ? BlobStatus::kTooShort : BlobStatus::kBadSize)
        << size << " bytes";
  }
}

TEST_P(Corruption, RefusesEveryOneByteExtension) {
  Bytes longer = golden(GetParam());
  longer.push_back({});
  for (int value = 0; value < 256; ++value) {
    longer.back() = static_cast<std::byte>(value);
    ASSERT_EQ(open(longer), BlobStatus::kBadSize);
  }
}

TEST_P(Corruption, RefusesEveryBitFlip) {
  Bytes bytes = golden(GetParam());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    ASSERT_NE(open(bytes), BlobStatus::kOk) << "bit " << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
}

TEST_P(Corruption, RefusesOrSurvivesResealedWords) {
  const Bytes whole = golden(GetParam());
  const std::uint32_t values[] = {0,           1,           0x7FFFFFFFU, 0x80000000U,
                                  0xFFFFFFFFU, 0x00FFFFFFU, 0x7FC00000U, 0xFF7FFFFFU};
  int accepted = 0;
  for (std::size_t at = 0; at + 4 <= whole.size(); at += 4) {
    std::uint32_t original;
    std::memcpy(&original, &whole[at], 4);
    for (int k = 0; k < 12; ++k) {
      const std::uint32_t value = k < 8     ? values[k]
                                  : k == 8  ? original + 1
                                  : k == 9  ? original - 1
                                  : k == 10 ? original << 1
                                            : original >> 1;
      Bytes bytes = whole;
      std::memcpy(&bytes[at], &value, 4);
      builder::seal(bytes);
      const ExactBuffer buffer(bytes);
      BlobView view;
      if (core::open_blob(buffer.span(), view) == BlobStatus::kOk) {
        ++accepted;
        use(view, static_cast<std::uint32_t>(at));
      }
    }
  }
  EXPECT_GT(accepted, 0);  // normals, names and such may change
}

struct FieldCase {
  const char* name;
  BlobStatus expected;
  std::function<void(BlobHeader&)> damage;
};

TEST_P(Corruption, ChecksEveryHeaderField) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const FieldCase cases[] = {
      {"magic", BlobStatus::kBadMagic, [](BlobHeader& h) { h.magic[7] = 1; }},
      {"newer major", BlobStatus::kBadVersion, [](BlobHeader& h) { ++h.version_major; }},
      {"total_bytes", BlobStatus::kBadSize, [](BlobHeader& h) { h.total_bytes -= 4; }},
      {"header_bytes short", BlobStatus::kBadHeader, [](BlobHeader& h) { h.header_bytes -= 4; }},
      {"header_bytes odd", BlobStatus::kBadHeader, [](BlobHeader& h) { h.header_bytes += 1; }},
      {"header_bytes huge", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.header_bytes = 0xFFFFFFFCU; }},
      {"profile", BlobStatus::kBadHeader, [](BlobHeader& h) { h.profile = 2; }},
      {"depth 0", BlobStatus::kBadHeader, [](BlobHeader& h) { h.depth = 0; }},
      {"depth 12", BlobStatus::kBadHeader, [](BlobHeader& h) { h.depth = core::kMaxDepth + 1; }},
      {"no points", BlobStatus::kBadHeader, [](BlobHeader& h) { h.point_count = 0; }},
      {"no leaves", BlobStatus::kBadHeader, [](BlobHeader& h) { h.leaf_count = 0; }},
      {"no nodes", BlobStatus::kBadHeader, [](BlobHeader& h) { h.node_count = 0; }},
      {"leaves > points", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.leaf_count = h.point_count + 1; }},
      {"nodes limit", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.node_count = core::kMaxNodes + 1; }},
      {"materials limit", BlobStatus::kBadHeader, [](BlobHeader& h) { h.material_count = 256; }},
      {"leaf max 0", BlobStatus::kBadHeader, [](BlobHeader& h) { h.points_per_leaf_max = 0; }},
      {"leaf max large", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_leaf_max = h.point_count + 1; }},
      {"leaf max small", BlobStatus::kBadLeaves, [](BlobHeader& h) { --h.points_per_leaf_max; }},
      {"ball max 0", BlobStatus::kBadHeader, [](BlobHeader& h) { h.points_per_ball_max = 0; }},
      {"ball max large", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_ball_max = h.point_count + 1; }},
      {"support max large", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_support_max = h.points_per_ball_max + 1; }},
      {"support max at its limit", BlobStatus::kOk,
       [](BlobHeader& h) { h.points_per_support_max = h.points_per_ball_max; }},
      {"support max unknown", BlobStatus::kOk, [](BlobHeader& h) { h.points_per_support_max = 0; }},
      {"query max small", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_query_max = h.points_per_leaf_max - 1; }},
      {"query max large", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_query_max = h.point_count + 1; }},
      {"slab max 0", BlobStatus::kBadHeader, [](BlobHeader& h) { h.points_per_slab_max = 0; }},
      {"slab max large", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.points_per_slab_max = h.points_per_query_max + 1; }},
      {"leaves a query", BlobStatus::kBadHeader, [](BlobHeader& h) { h.leaves_per_query_max = 7; }},
      {"leaf groups", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.leaf_group_shift = core::kMaxLeafGroupShift + 1; }},
      {"directory of leaves", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.directory_level = h.depth; }},
      {"directory level huge", BlobStatus::kBadHeader,
       [](BlobHeader& h) { h.directory_level = 0xFFFFFFFFU; }},
      {"reserved", BlobStatus::kBadHeader, [](BlobHeader& h) { h.reserved[2] = 1; }},
      {"name unterminated", BlobStatus::kBadHeader,
       [](BlobHeader& h) { std::memset(h.name, 'x', 32); }},
      {"name after its end", BlobStatus::kBadHeader,
       [](BlobHeader& h) {
         h.name[31] = 'x';
         h.name[30] = 0;
       }},
      {"tool unterminated", BlobStatus::kBadHeader,
       [](BlobHeader& h) { std::memset(h.tool_version, 'x', 16); }},
      {"step 0", BlobStatus::kBadFigures, [](BlobHeader& h) { h.step_m = 0.0F; }},
      {"step NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.step_m = nan; }},
      {"step negative", BlobStatus::kBadFigures, [](BlobHeader& h) { h.step_m = -h.step_m; }},
      {"step inexact", BlobStatus::kBadFigures,
       [](BlobHeader& h) {
         h.step_m = std::bit_cast<float>(std::bit_cast<std::uint32_t>(h.step_m) | 1U);
         h.leaf_edge_min_m = h.step_m * 2048.0F;
       }},
      {"root low", BlobStatus::kBadFigures, [](BlobHeader& h) { h.root_min[0] = INT32_MIN; }},
      {"root high", BlobStatus::kBadFigures, [](BlobHeader& h) { h.root_min[2] = INT32_MAX; }},
      {"leaf edge", BlobStatus::kBadFigures, [](BlobHeader& h) { h.leaf_edge_min_m *= 2.0F; }},
      {"spacing 0", BlobStatus::kBadFigures, [](BlobHeader& h) { h.spacing_m = 0.0F; }},
      {"spacing NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.spacing_m = nan; }},
      {"support NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.support_radius_m = nan; }},
      {"aabb negative", BlobStatus::kBadFigures, [](BlobHeader& h) { h.aabb_edge_m = -1.0F; }},
      {"offset NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.six_point_offset_m = nan; }},
      {"gap NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.largest_gap_m = nan; }},
      {"reach > leaf", BlobStatus::kBadFigures,
       [](BlobHeader& h) { h.reach_m = 0.5F * h.leaf_edge_min_m; }},
      {"reach negative", BlobStatus::kBadFigures, [](BlobHeader& h) { h.reach_m = -1.0F; }},
      {"reach NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.reach_m = nan; }},
      {"bounds NaN", BlobStatus::kBadFigures, [=](BlobHeader& h) { h.bounds_max_m[1] = nan; }},
      {"bounds swapped", BlobStatus::kBadFigures,
       [](BlobHeader& h) { std::swap(h.bounds_min_m[0], h.bounds_max_m[0]); }},
      {"bounds outside", BlobStatus::kBadFigures,
       [](BlobHeader& h) { h.bounds_min_m[2] -= 100.0F; }},
      {"nodes offset", BlobStatus::kBadSections, [](BlobHeader& h) { h.nodes.offset += 4; }},
      {"directory bytes", BlobStatus::kBadSections, [](BlobHeader& h) { h.directory.bytes += 4; }},
      {"leaf bases bytes", BlobStatus::kBadSections,
       [](BlobHeader& h) { h.leaf_bases.bytes += 4; }},
      {"leaf offsets bytes", BlobStatus::kBadSections,
       [](BlobHeader& h) { h.leaf_offsets.bytes -= 2; }},
      {"points bytes", BlobStatus::kBadSections, [](BlobHeader& h) { h.points.bytes -= 4; }},
      {"normals offset wraps", BlobStatus::kBadSections,
       [](BlobHeader& h) { h.normals.offset = 0xFFFFFFFCU; }},
      {"neighbours bytes", BlobStatus::kBadSections,
       [](BlobHeader& h) { h.neighbours.bytes = h.neighbours.bytes == 0 ? 24 : 0; }},
      {"one material less", BlobStatus::kBadSections, [](BlobHeader& h) { --h.material_count; }},
      {"point count", BlobStatus::kBadSections, [](BlobHeader& h) { ++h.point_count; }},
      {"leaf count", BlobStatus::kBadSections, [](BlobHeader& h) { --h.leaf_count; }},
      {"node count", BlobStatus::kBadSections, [](BlobHeader& h) { ++h.node_count; }},
  };
  for (const FieldCase& field : cases) {
    Bytes bytes = golden(GetParam());
    BlobHeader header = header_of(bytes);
    field.damage(header);
    std::memcpy(bytes.data(), &header, sizeof header);
    builder::seal(bytes);
    EXPECT_EQ(open(bytes), field.expected) << field.name;
  }
}

/// Puts bytes behind the header; the sections move.
Bytes with_longer_header(Bytes bytes, std::uint16_t minor, const std::vector<std::byte>& more) {
  BlobHeader header = header_of(bytes);
  const auto size = static_cast<std::uint32_t>(more.size());
  header.version_minor = minor;
  header.header_bytes += size;
  header.total_bytes += size;
  for (core::BlobSection* s :
       {&header.nodes, &header.directory, &header.leaf_bases, &header.leaf_offsets, &header.points,
        &header.normals, &header.neighbours, &header.materials, &header.material_indices}) {
    s->offset += size;
  }
  bytes.insert(bytes.begin() + sizeof header, more.begin(), more.end());
  std::memcpy(bytes.data(), &header, sizeof header);
  builder::seal(bytes);
  return bytes;
}

TEST_P(Corruption, ReadsHeaderOfNewerMinor) {
  std::vector<std::byte> more(16, std::byte{0x5A});
  std::fill_n(more.begin(), sizeof(core::BlobExtension), std::byte{0});  // no interior
  EXPECT_EQ(open(with_longer_header(golden(GetParam()), 9, more)), BlobStatus::kOk);
}

TEST_P(Corruption, IgnoresExtensionOfMinorZero) {
  const std::vector<std::byte> more(8, std::byte{0x5A});
  EXPECT_EQ(open(with_longer_header(golden(GetParam()), 0, more)), BlobStatus::kOk);
  EXPECT_EQ(open(with_longer_header(golden(GetParam()), 1, more)), BlobStatus::kBadSections);
}

/// The golden blob with an interior that is described by `extension`.
BlobStatus open_with_interior(Profile profile, core::BlobSection interior,
                              std::byte value = std::byte{0}) {
  std::vector<std::byte> more(sizeof interior);
  std::memcpy(more.data(), &interior, sizeof interior);
  const BlobHeader header = header_of(golden(profile));
  more.resize(more.size() + (header.node_count + header.leaf_count + 3U) / 4U * 4U, value);
  return open(with_longer_header(golden(profile), 1, more));
}

TEST(Corruption, ChecksInterior) {
  const BlobHeader header = header_of(golden(Profile::kSurface));
  const std::uint32_t bytes = header.node_count + header.leaf_count;
  const std::uint32_t end = 352U + (bytes + 3U) / 4U * 4U;
  EXPECT_EQ(open_with_interior(Profile::kSurface, {352, bytes}), BlobStatus::kOk);
  EXPECT_EQ(open_with_interior(Profile::kSurface, {end - bytes, bytes}), BlobStatus::kOk);
  for (const core::BlobSection bad : {core::BlobSection{348, bytes},
                                      {end - bytes + 1U, bytes},
                                      {0xFFFFFFF0U, bytes},
                                      {352, bytes - 1U},
                                      {352, bytes + 1U},
                                      {352, 0}}) {
    EXPECT_EQ(open_with_interior(Profile::kSurface, bad), BlobStatus::kBadSections)
        << bad.offset << " " << bad.bytes;
  }
  EXPECT_EQ(open_with_interior(Profile::kSurface, {352, bytes}, std::byte{0xFF}),
            BlobStatus::kBadTree)
      << "marks octants that are nodes";
  const BlobHeader paper = header_of(golden(Profile::kPaper));
  EXPECT_EQ(open_with_interior(Profile::kPaper, {352, paper.node_count + paper.leaf_count}),
            BlobStatus::kBadSections);
}

struct WordCase {
  const char* name;
  BlobStatus expected;
  std::function<std::size_t(const BlobHeader&)> at;  // byte offset of the word
  std::function<std::uint32_t(std::uint32_t)> damage;
};

TEST_P(Corruption, ChecksEveryStructure) {
  const auto plus = [](std::uint32_t n) { return [n](std::uint32_t v) { return v + n; }; };
  const auto set = [](std::uint32_t n) { return [n](std::uint32_t) { return n; }; };
  const WordCase cases[] = {
      {"first leaf does not start at 0", BlobStatus::kBadLeaves,
       [](const BlobHeader& h) { return h.leaf_bases.offset; }, plus(1)},
      {"group does not start at its base", BlobStatus::kBadLeaves,
       [](const BlobHeader& h) { return h.leaf_offsets.offset; }, plus(1)},
      {"empty leaf", BlobStatus::kBadLeaves,
       [](const BlobHeader& h) { return h.leaf_offsets.offset; }, set(0)},
      {"leaf past the points", BlobStatus::kBadLeaves,
       [](const BlobHeader& h) { return h.leaf_offsets.offset; }, set(0xFFFF0000U)},
      {"base past the points", BlobStatus::kBadLeaves,
       [](const BlobHeader& h) { return h.leaf_bases.offset + h.leaf_bases.bytes - 4; },
       set(0xFFFFFFF0U)},
      {"root is its own child", BlobStatus::kBadTree,
       [](const BlobHeader& h) { return h.nodes.offset; },
       [](std::uint32_t v) { return v & 0xFF000000U; }},
      {"node without children", BlobStatus::kBadTree,
       [](const BlobHeader& h) { return h.nodes.offset; }, set(0)},
      {"child past the nodes", BlobStatus::kBadTree,
       [](const BlobHeader& h) { return h.nodes.offset; },
       [](std::uint32_t v) { return v | 0x00FFFFFFU; }},
      {"second node's group is not the next", BlobStatus::kBadTree,
       [](const BlobHeader& h) { return h.nodes.offset + 4; }, plus(1)},
      {"point out of order", BlobStatus::kBadPoints,
       [](const BlobHeader& h) { return h.points.offset; }, set(0xFFFFFFFCU)},
      {"material past the table", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.material_indices.offset; }, set(0x02010101U)},
      {"stiffness NaN", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset; }, set(0x7FC00000U)},
      {"stiffness negative", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset; }, set(0xBF800000U)},
      {"damping infinite", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 4; }, set(0x7F800000U)},
      {"static friction NaN", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 8; }, set(0x7FC00000U)},
      {"dynamic above static", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 12; }, set(0x3F800000U)},
      {"texture height NaN", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 16; }, set(0x7FC00000U)},
      {"wavelength NaN", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 20; }, set(0x7FC00000U)},
      {"material reserved", BlobStatus::kBadMaterials,
       [](const BlobHeader& h) { return h.materials.offset + 28; }, set(1)},
  };
  for (const WordCase& word : cases) {
    Bytes bytes = golden(GetParam());
    const std::size_t at = word.at(header_of(bytes));
    std::uint32_t value;
    std::memcpy(&value, &bytes[at], 4);
    value = word.damage(value);
    std::memcpy(&bytes[at], &value, 4);
    builder::seal(bytes);
    EXPECT_EQ(open(bytes), word.expected) << word.name;
  }
}

TEST(Corruption, RefusesAmbiguousOctants) {
  Bytes bytes = golden(Profile::kPaper);
  const std::uint32_t value = 0xFF000000U;
  std::memcpy(&bytes[header_of(bytes).nodes.offset + 4], &value, 4);
  builder::seal(bytes);
  EXPECT_EQ(open(bytes), BlobStatus::kBadTree);
}

TEST(Corruption, ChecksEveryDirectoryEntry) {
  const Bytes whole = golden(Profile::kSurface);
  const BlobHeader header = header_of(whole);
  ASSERT_GE(header.directory_level, 1U);
  ASSERT_EQ(header.directory.bytes, 4U << 3U * header.directory_level);
  for (std::uint32_t at = 0; at < header.directory.bytes; at += 4) {
    std::uint32_t entry;
    std::memcpy(&entry, &whole[header.directory.offset + at], 4);
    for (const std::uint32_t value : {entry + 1U, entry - 1U, 0U, core::kNoNode}) {
      if (value == entry) continue;
      Bytes bytes = whole;
      std::memcpy(&bytes[header.directory.offset + at], &value, 4);
      builder::seal(bytes);
      ASSERT_EQ(open(bytes), BlobStatus::kBadTree) << at;
    }
  }
}

TEST(Corruption, RefusesDirectoryInPaperBlob) {
  Bytes bytes = golden(Profile::kPaper);
  BlobHeader header = header_of(bytes);
  header.directory_level = 1;
  std::memcpy(bytes.data(), &header, sizeof header);
  builder::seal(bytes);
  EXPECT_EQ(open(bytes), BlobStatus::kBadHeader);
}

TEST(Corruption, ChecksNeighbourEntries) {
  for (const std::uint32_t value :
       {0x00FFFFFFU, 0x80FFFFFFU, 0x0F000000U, 0xFF000000U, 0x7F000000U}) {
    Bytes bytes = golden(Profile::kPaper);
    std::memcpy(&bytes[header_of(bytes).neighbours.offset], &value, 4);
    builder::seal(bytes);
    EXPECT_EQ(open(bytes), BlobStatus::kBadNeighbours) << std::hex << value;
  }
}

TEST(Corruption, RefusesNonZeroPadding) {
  builder::Model model = test::cos_sheet(0.01, 0.0025, Profile::kSurface);  // 81 points: odd
  Bytes bytes = builder::write_blob(model).bytes;
  const BlobHeader header = header_of(bytes);
  ASSERT_NE(header.normals.bytes % 4, 0U);
  bytes[header.normals.offset + header.normals.bytes] = std::byte{1};
  builder::seal(bytes);
  EXPECT_EQ(open(bytes), BlobStatus::kBadSections);
}

TEST(Corruption, RefusesMisalignedBytes) {
  const Bytes bytes = golden(Profile::kSurface);
  Bytes shifted(1);
  shifted.insert(shifted.end(), bytes.begin(), bytes.end());
  BlobView view;
  EXPECT_EQ(core::open_blob(std::span(shifted).subspan(1, bytes.size()), view),
            BlobStatus::kMisaligned);
}

TEST(Corruption, DescribesEveryStatus) {
  for (int status = 0; status <= static_cast<int>(BlobStatus::kBadMaterials); ++status) {
    EXPECT_STRNE(core::describe(static_cast<BlobStatus>(status)), "unknown status");
  }
}

}  // namespace
}  // namespace tactree
