// COLLADA: skins in the pose of the file, parts that are missing.

#include "test_files.hpp"

namespace tactree::builder {
namespace {

std::string dae(const std::string& controllers, const std::string& nodes) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>)" +
         controllers + R"(<library_visual_scenes><visual_scene id="s">)" + nodes +
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

/// A skin whose shape is moved by 100 along x when it is bound. The first bone has points 0 and 1,
/// the second point 2. The second was bound at z = 5.
std::string skin() {
  return R"(<library_controllers><controller id="c"><skin source="#g">
<bind_shape_matrix>1 0 0 100 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
<source id="cj"><Name_array id="cja" count="2">J K</Name_array><technique_common>
<accessor source="#cja" count="2" stride="1"><param name="JOINT" type="Name"/></accessor></technique_common></source>
<source id="cm"><float_array id="cma" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1 -5 0 0 0 1</float_array>
<technique_common><accessor source="#cma" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="cw"><float_array id="cwa" count="1">1</float_array><technique_common>
<accessor source="#cwa" count="1" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#cj"/><input semantic="INV_BIND_MATRIX" source="#cm"/></joints>
<vertex_weights count="3"><input semantic="JOINT" source="#cj" offset="0"/><input semantic="WEIGHT" source="#cw" offset="1"/>
<vcount>1 1 1</vcount><v>0 0 0 0 1 0</v></vertex_weights></skin></controller></library_controllers>)";
}

std::string bone(const std::string& name, const std::string& content) {
  return "<node id=\"" + name + "\" sid=\"" + name + "\" name=\"" + name + "\" type=\"JOINT\">" +
         content + "</node>";
}

const std::string kSkinned =
    R"(<node id="n"><translate>7 7 7</translate><instance_controller url="#c"><skeleton>#J</skeleton></instance_controller></node>)";

class Collada : public TestFiles {};

TEST_F(Collada, PosesSkinsByTheirBones) {
  const Scan scan = read(dae(skin(), bone("J", "<translate>0 20 0</translate>" +
                                                   bone("K", "<translate>0 0 9</translate>")) +
                                         kSkinned));
  EXPECT_EQ(scan.unit_m, 0.0254);
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_LT((scan.positions[0] - Eigen::Vector3d(100, 20, 0)).norm(), 1e-4);
  EXPECT_LT((scan.positions[1] - Eigen::Vector3d(101, 20, 0)).norm(), 1e-4);
  EXPECT_LT((scan.positions[2] - Eigen::Vector3d(100, 21, 4)).norm(), 1e-4);
  EXPECT_TRUE(scan.warnings.empty());
}

/// A bone that mirrors turns the windings around, as a node does.
TEST_F(Collada, KeepsOutsideOfMirroredSkins) {
  const Scan scan =
      read(dae(skin(), bone("J", "<scale>-1 1 1</scale>" + bone("K", "")) + kSkinned));
  EXPECT_NEAR(scan.positions.at(1).x(), -101, 1e-4);
  EXPECT_EQ(scan.triangles.at(0), (std::array<std::uint32_t, 3>{0, 2, 1}));
}

TEST_F(Collada, NamesBonesWithoutPlace) {
  const Scan scan = read(dae(skin(), bone("J", "") + kSkinned));
  ASSERT_EQ(scan.positions.size(), 3U);
  expect_parts(scan.warnings.at(0), "The place of the bone \"K\" is not known", "Blender");
}

TEST_F(Collada, NamesPartsThatAreNotRead) {
  const std::string node = R"(<node id="n"><instance_geometry url="#g"/></node>)";
  EXPECT_TRUE(read(dae("", node)).warnings.empty());
  const Scan missing = read(dae("", node + R"(<node id="k"><instance_geometry url="#h"/></node>)"));
  EXPECT_EQ(missing.triangles.size(), 1U);
  expect_parts(missing.warnings.at(0), "1 (\"#h\") of its instances", "incomplete");
  const Scan nodes = read(dae("", node + R"(<node id="k"><instance_node url="#lib"/></node>)"));
  expect_parts(nodes.warnings.at(0), "1 (\"#lib\") of its instances");
  expect_parts(
      refusal_of(dae("", node + R"(<node id="k"><instance_geometry url="b.dae#g"/></node>)")),
      "\"b.dae#g\" is in another file", "join the files");
  const Scan spline =
      read(dae(R"(<library_geometries><geometry id="s"><spline/></geometry></library_geometries>)",
               node + R"(<node id="k"><instance_geometry url="#s"/></node>)"));
  expect_parts(spline.warnings.at(0), "1 (\"s\") of its geometries are not meshes");
}

TEST_F(Collada, RefusesWhatIsReadWrong) {
  const std::string instance = R"(<instance_geometry url="#g"/></node>)";
  expect_parts(refusal_of(dae("", "<node id=\"n\"><skew>45 0 1 0 1 0 0</skew>" + instance)),
               "a node is skewed", "apply the transforms");
  for (const std::string bad : {"0", "-1", "nan"}) {
    std::string unit = dae("", "<node id=\"n\">" + instance);
    unit.replace(unit.find("0.0254"), 6, bad);
    expect_parts(refusal_of(unit), "\"" + bad + "\" is not a unit in metres");
  }
}

}  // namespace
}  // namespace tactree::builder
