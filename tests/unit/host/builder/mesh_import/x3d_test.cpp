// X3D: the shapes that assimp leaves out are named, and the unit of the file is read.

#include "test_files.hpp"

namespace tactree::builder {
namespace {

const std::string kShape =
    R"(<Shape><IndexedFaceSet coordIndex="0 1 2 -1"><Coordinate point="0 0 0 1 0 0 0 2 0"/></IndexedFaceSet></Shape>)";

std::string x3d(const std::string& scene, const std::string& head = "") {
  return R"(<?xml version="1.0"?><X3D profile="Interchange" version="3.3"><head>)" + head +
         "</head><Scene>" + scene + "</Scene></X3D>";
}

class X3d : public TestFiles {};

TEST_F(X3d, ReadsShapesOfGroups) {
  const Scan scan =
      read(x3d("<Transform translation=\"5 0 0\"><Group>" + kShape +
               "</Group></Transform><Viewpoint/><Background/><WorldInfo/>" +
               R"(<Shape><Appearance><Material/></Appearance><Box size="2 2 2"/></Shape>)"));
  EXPECT_GE(scan.positions.size(), 11U);
  EXPECT_EQ(scan.unit_m, 1.0);
  EXPECT_TRUE(scan.warnings.empty());
}

TEST_F(X3d, RefusesNodesWhoseShapesAreNotRead) {
  for (const std::string node : {"LOD", "Anchor", "Collision", "Billboard", "CADFace",
                                 "HAnimSegment", "ProtoDeclare", "GeoTransform"}) {
    const std::string scene = "<Transform>" + kShape + "</Transform><" + node + "><Group>" +
                              kShape + "</Group></" + node + ">";
    expect_parts(refusal_of(x3d(scene), "a.x3d"), "a.x3d", "its node \"" + node + "\" has shapes",
                 "export it as glTF, PLY or STL");
  }
  const std::string used = "<Group DEF=\"G\">" + kShape + "</Group>";
  expect_parts(refusal_of(x3d(used + "<LOD><Group USE=\"G\"/></LOD>")), "\"LOD\"");
  expect_parts(refusal_of(x3d(kShape + "<LOD><Inline url=\"b.x3d\"/></LOD>")), "\"LOD\"");
  EXPECT_EQ(read(x3d(kShape + "<Collision/><LOD/>")).triangles.size(), 1U);
}

TEST_F(X3d, RefusesGeometryThatIsNotRead) {
  for (const std::string node :
       {"QuadSet", "IndexedQuadSet", "NurbsPatchSurface", "ProtoInstance"}) {
    const std::string shape =
        "<Shape><" + node + "><Coordinate point=\"0 0 0\"/></" + node + "></Shape>";
    expect_parts(refusal_of(x3d(kShape + shape)), "its node \"" + node + "\" has shapes");
  }
  std::string wide = kShape;
  wide.replace(wide.find("Coordinate "), 11, "CoordinateDouble ");
  expect_parts(refusal_of(x3d(kShape + wide)), "\"CoordinateDouble\"");
  const Scan scan = read(x3d(kShape + "<Shape><Text string='a'/></Shape>"));
  EXPECT_EQ(scan.triangles.size(), 1U);
  expect_parts(scan.warnings.at(0), "1 nodes \"Text\" were left out");
}

TEST_F(X3d, ReadsUnitOfFile) {
  const auto unit = [](const std::string& category, const std::string& factor) {
    return x3d(kShape,
               "<unit category=\"force\" conversionFactor=\"7\" name=\"f\"/><unit category=\"" +
                   category + "\" conversionFactor=\"" + factor + "\" name=\"u\"/>");
  };
  const Scan scan = read(unit("length", "0.001"));
  EXPECT_EQ(scan.unit_m, 0.001);
  EXPECT_EQ(scan.positions.at(1).x(), 1.0);
  EXPECT_EQ(read(unit("angle", "1.0")).unit_m, 1.0);
  expect_parts(refusal_of(unit("angle", "0.0174533")), "angles are not in radians");
  for (const char* const bad : {"0,001", "0", "-1", "nan", ""}) {
    expect_parts(refusal_of(unit("length", bad)), "is not a factor of a unit");
  }
}

TEST_F(X3d, RefusesDamage) {
  std::string word = kShape;
  word.replace(word.find("2 0\""), 3, "0x2 0");
  expect_parts(refusal_of(x3d(word)), "\"0x2 0\" is not a coordinate of a point");
  const std::string whole = x3d(kShape);
  expect_parts(refusal_of(whole.substr(0, whole.size() / 2)), "cannot be read");
  std::string deep;
  for (int i = 0; i < 2000; ++i) deep += "<Group>";
  for (int i = 0; i < 2000; ++i) deep += "</Group>";
  expect_parts(refusal_of(x3d(deep)), "more than 1000 deep");
}

}  // namespace
}  // namespace tactree::builder
