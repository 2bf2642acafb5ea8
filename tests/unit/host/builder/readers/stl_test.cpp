#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

class StlTest : public TestFiles {};

std::string binary(std::uint32_t count, const std::string& facets,
                   const std::string& comment = "made for a test") {
  std::string header = comment;
  header.resize(80, ' ');
  return header + bytes_of(count) + facets;
}

std::string two_facets() {
  return facet({Corner{0, 0, 0}, Corner{1, 0, 0}, Corner{1, 1, 0}}) +
         facet({Corner{1, 1, 0}, Corner{0, 1, 0}, Corner{-0.0F, 0, 0}});
}

constexpr const char* kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1e0 0\n"
    " endloop\nendfacet\n";

TEST_F(StlTest, BinaryJoinsEqualCorners) {
  const Scan scan = read(binary(2, two_facets()));
  EXPECT_EQ(scan.format, "STL binary");
  EXPECT_EQ(scan.positions.size(), 4U);
  ASSERT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(scan.triangles[1], (Triangle{2, 3, 0}));
}

TEST_F(StlTest, RecognisesBinaryBeginningLikeText) {
  EXPECT_EQ(read(binary(2, two_facets(), "solid thing")).triangles.size(), 2U);
}

TEST_F(StlTest, ManyCornersJoinExactly) {
  // A grid of n x n squares; every inner point is the corner of six triangles.
  constexpr int kSide = 60;
  std::string facets;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const auto at = [](int x, int y) {
        return Corner{static_cast<float>(x) * 0.1F, static_cast<float>(y) * 0.1F, 0};
      };
      facets += facet({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      facets += facet({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const Scan scan = read(binary(2 * kSide * kSide, facets));
  EXPECT_EQ(scan.positions.size(), static_cast<std::size_t>((kSide + 1) * (kSide + 1)));
  EXPECT_EQ(scan.triangles.size(), static_cast<std::size_t>(2 * kSide * kSide));
}

TEST_F(StlTest, ReadsText) {
  const Scan scan = read(std::string("solid a b\n") + kFacet + "endsolid a b\nsolid\nendsolid\n");
  EXPECT_EQ(scan.format, "STL ascii");
  EXPECT_EQ(scan.positions.size(), 3U);
  EXPECT_EQ(scan.triangles.size(), 1U);
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_EQ(read(std::string("SOLID\r\n") + kFacet + "ENDSOLID\r\n").triangles.size(), 1U);
}

TEST_F(StlTest, DropsNonFiniteAndDegenerate) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string facets = two_facets() +
                             facet({Corner{5, 5, 5}, Corner{nan, 0, 0}, Corner{1, 1, 0}}) +
                             facet({Corner{0, 0, 0}, Corner{0, 0, 0}, Corner{1, 1, 0}});
  const Scan scan = read(binary(4, facets));
  EXPECT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(dropped(scan, "non_finite"), 1U);
  EXPECT_EQ(dropped(scan, "face_non_finite"), 1U);
  EXPECT_EQ(dropped(scan, "degenerate_face"), 1U);
}

TEST_F(StlTest, ChecksDeclaredCounts) {
  expect_parts(refusal_of(binary(4294967295U, two_facets()), "m.stl"), "m.stl", "byte 80",
               "4294967295 triangles", "holds 2");
  expect_parts(refusal_of(binary(3, two_facets())), "declares 3", "holds 2");
  const std::string cut = binary(2, two_facets().substr(0, 77));
  expect_parts(refusal_of(cut), "byte " + std::to_string(cut.size()), "holds 1", "cut off");
  expect_parts(refusal_of(binary(0, "")), "no triangle");
}

// Only a named format leads there: the content does not tell what the file is.
TEST_F(StlTest, RefusesFileShorterThanHeader) {
  ReadOptions options;
  options.format = "stl";
  const std::string whole = binary(1, two_facets().substr(0, 50));
  for (const std::size_t size : {1U, 57U, 79U, 80U, 83U}) {
    const std::string cut = std::string("\x03") + whole.substr(1, size - 1U);
    expect_parts(refusal(write("cut", cut), options), "byte " + std::to_string(size), "header");
  }
  expect_parts(refusal(write("cut", whole.substr(0, 84)), options), "holds 0");
}

TEST_F(StlTest, NamesLineOfDamage) {
  const std::string solid = std::string("solid\n") + kFacet;
  expect_parts(refusal_of(solid + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
               "inside a triangle", "1 complete", "line 11");
  expect_parts(refusal_of(solid + "facet normal 0 0 1\nvertex 0 0\n"), "line 10", "not a number");
  expect_parts(refusal_of(solid + "facet normal 0 0 1\nvertex 0 0 0\nendfacet\n"), "line 11",
               "1 vertices");
  expect_parts(refusal_of(solid + "vertex 0 0 0\n"), "outside a triangle");
  expect_parts(refusal_of(solid + "and so on\n"), "line 9", "\"and\"");
  expect_parts(refusal_of("solid empty\nendsolid empty\n"), "no triangle");
  const Scan unended = read(solid);
  EXPECT_EQ(unended.triangles.size(), 1U);
  EXPECT_EQ(unended.warnings.size(), 1U);
}

}  // namespace
}  // namespace tactree::builder
