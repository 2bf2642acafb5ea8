// 3MF projects of slicers: modifiers, supports and what is not printed are not part of the body.

#include "mesh_writers.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using test::ZipWriter;
using Triangle = std::array<std::uint32_t, 3>;

/// Two volumes, as PrusaSlicer writes them: triangles 0 and 1 use the points 0 to 3, triangle 2 the
/// points 4 to 6.
const std::string kVolumes =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="2" z="0"/><vertex x="0" y="0" z="3"/><vertex x="90" y="0" z="0"/><vertex x="90" y="9" z="0"/><vertex x="90" y="9" z="9"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="4" v2="5" v3="6"/></triangles></mesh>)";

std::string body(const std::string& id, const std::string& content,
                 const std::string& type = "model") {
  return "<object id=\"" + id + "\" type=\"" + type + "\">" + content + "</object>";
}

std::string build_of(const std::string& resources, const std::string& build) {
  return R"(<?xml version="1.0" encoding="UTF-8"?><model unit="millimeter"><resources>)" +
         resources + "</resources><build>" + build + "</build></model>";
}

std::string project(const std::string& root, const std::string& name = "other",
                    const std::string& settings = "") {
  return ZipWriter().add("3D/3dmodel.model", root).add("Metadata/" + name, settings).bytes();
}

std::string slic3r(const std::string& last, const std::string& metadata) {
  return R"(<config><object id="1"><volume firstid="0" lastid="1"><metadata type="volume" key="volume_type" value="ModelPart"/></volume><volume firstid="2" lastid=")" +
         last + "\">" + metadata + "</volume></object></config>";
}

std::string one_object() { return build_of(body("1", kVolumes), R"(<item objectid="1"/>)"); }

std::string typed(const std::string& type) {
  return R"(<metadata type="volume" key="volume_type" value=")" + type + "\"/>";
}

class SlicerVolumes : public TestFiles {
 protected:
  Scan read_slic3r(const std::string& metadata) {
    return read(project(one_object(), "Slic3r_PE_model.config", slic3r("2", metadata)));
  }
};

TEST_F(SlicerVolumes, LeavesOutVolumesOfPrusaSlicer) {
  EXPECT_EQ(read_slic3r(typed("ModelPart")).positions.size(), 7U);
  const std::pair<std::string, std::string> kinds[] = {
      {typed("ParameterModifier"), "1 modifier"},
      {R"(<metadata key="modifier" value="1"/>)", "1 modifier"},
      {typed("NegativeVolume"), "1 negative volume (not subtracted)"},
      {typed("SupportEnforcer"), "1 support enforcer"},
      {typed("SupportBlocker"), "1 support blocker"}};
  for (const auto& [metadata, name] : kinds) {
    const Scan scan = read_slic3r(metadata);
    EXPECT_EQ(scan.positions.size(), 4U) << metadata;
    EXPECT_EQ(scan.triangles.at(1), (Triangle{0, 1, 3})) << metadata;
    expect_parts(scan.warnings.at(0), "left out: " + name + ".");
  }
}

TEST_F(SlicerVolumes, KeepsVolumesOfUnknownType) {
  const Scan unknown = read_slic3r(typed("Wheel"));
  EXPECT_EQ(unknown.positions.size(), 7U);
  expect_parts(unknown.warnings.at(0), "were read: 1 volume of the type \"Wheel\"");
}

/// The points before the rest move up when those of the first volume go.
TEST_F(SlicerVolumes, RenumbersPointsBehindVolume) {
  const std::string settings =
      R"(<config><object id="1"><volume firstid="0" lastid="1"><metadata key="volume_type" value="SupportBlocker"/></volume></object></config>)";
  const Scan scan = read(project(one_object(), "Slic3r_PE_model.config", settings));
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(90, 0, 0));
  EXPECT_EQ(scan.triangles.at(0), (Triangle{0, 1, 2}));
}

TEST_F(SlicerVolumes, RefusesVolumesBeyondMesh) {
  const std::string modifier = R"(<metadata key="modifier" value="1"/>)";
  for (const char* const last : {"3", "4294967295", "1", "x", ""}) {
    expect_parts(
        refusal_of(project(one_object(), "Slic3r_PE_model.config", slic3r(last, modifier))),
        "Slic3r_PE_model.config", "has triangles 2 to " + std::string(last) + " of 3",
        "save the file again");
  }
  expect_parts(refusal_of(project(one_object(), "Slic3r_PE_model.config", "<config>")),
               "was cut off");
}

TEST_F(SlicerVolumes, LeavesOutPartsOfOrcaSlicer) {
  const std::string root = build_of(
      body("1", kVolumes) + body("2", kVolumes) +
          body("3",
               R"(<components><component objectid="1"/><component objectid="2"/></components>)"),
      R"(<item objectid="3"/>)");
  const auto read_parts = [&](const std::string& type, const std::string& part = "2") {
    return read(project(root, "model_settings.config",
                        R"(<config><object id="3"><part id="1" subtype="normal_part"/><part id=")" +
                            part + "\" subtype=\"" + type + "\"/></object></config>"));
  };
  EXPECT_EQ(read_parts("normal_part").positions.size(), 14U);
  for (const std::string type :
       {"modifier_part", "negative_part", "support_enforcer", "support_blocker"}) {
    const Scan scan = read_parts(type);
    EXPECT_EQ(scan.positions.size(), 7U) << type;
    expect_parts(scan.warnings.at(0), "left out: 1 ");
  }
  const Scan missing = read_parts("modifier_part", "9");
  EXPECT_EQ(missing.positions.size(), 14U);
  expect_parts(missing.warnings.at(0), "may not belong to the body were read: 1 modifier");
}

TEST_F(SlicerVolumes, LeavesOutTypesThatAreNotTheBody) {
  const std::string build = R"(<item objectid="1"/><item objectid="2"/>)";
  for (const std::string type : {"support", "solidsupport", "other"}) {
    const Scan scan =
        read(project(build_of(body("1", kVolumes) + body("2", kVolumes, type), build)));
    EXPECT_EQ(scan.positions.size(), 7U) << type;
    expect_parts(scan.warnings.at(0), "left out: 1 ");
  }
  const Scan surface =
      read(project(build_of(body("1", kVolumes) + body("2", kVolumes, "surface"), build)));
  EXPECT_EQ(surface.positions.size(), 14U);
  expect_parts(surface.warnings.at(0), "were read: 1 object of the type \"surface\"");
  const Scan cura = read(project(build_of(
      body("1", kVolumes) +
          body(
              "2",
              R"(<metadatagroup><metadata name="cura:infill_mesh">True</metadata><metadata name="cura:support_mesh">False</metadata></metadatagroup>)" +
                  kVolumes),
      build)));
  EXPECT_EQ(cura.positions.size(), 7U);
  expect_parts(cura.warnings.at(0), "left out: 1 modifier.");
}

TEST_F(SlicerVolumes, LeavesOutItemsThatAreNotPrinted) {
  const auto read_items = [&](const std::string& first, const std::string& second) {
    return project(build_of(body("1", kVolumes), "<item objectid=\"1\" printable=\"" + first +
                                                     "\"/><item objectid=\"1\" printable=\"" +
                                                     second + "\"/>"));
  };
  EXPECT_EQ(read(read_items("1", "true")).positions.size(), 14U);
  for (const char* const no : {"0", "false"}) {
    const Scan scan = read(read_items("1", no));
    EXPECT_EQ(scan.positions.size(), 7U);
    expect_parts(scan.warnings.at(0), "left out: 1 item that is not printed.");
  }
  expect_parts(refusal_of(read_items("0", "0")), "no points", "2 item that is not printed",
               "make it a printed part");
}

}  // namespace
}  // namespace tactree::builder
