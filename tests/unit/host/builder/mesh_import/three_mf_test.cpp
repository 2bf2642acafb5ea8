// 3MF: units, unused objects, components, parts of the production extension.

#include "mesh_writers.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using test::ZipWriter;
using Triangle = std::array<std::uint32_t, 3>;

const std::string kRelations =
    R"(<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";

const std::string kMesh =
    R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="2" z="0"/><vertex x="0" y="0" z="+3.5e0"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3" pid="1" p1="0"/><triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh>)";

std::string object(const std::string& id, const std::string& content) {
  return "<object id=\"" + id + "\" type=\"model\">" + content + "</object>";
}

std::string model(const std::string& resources, const std::string& build,
                  const std::string& attributes = R"(unit="millimeter")",
                  const std::string& before = "") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>)" + before + "<model " + attributes +
         R"( xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>)" +
         resources + "</resources><build>" + build + "</build></model>";
}

std::string package(const std::string& root, bool stored = false) {
  return ZipWriter(stored)
      .add("[Content_Types].xml", "<Types/>")
      .add("_rels/.rels", kRelations)
      .add("3D/3dmodel.model", root)
      .bytes();
}

class ThreeMfTest : public TestFiles {};

TEST_F(ThreeMfTest, ReadsBuildObjectsOnly) {
  const std::string root = model(object("9", kMesh) + object("1", kMesh),
                                 R"(<item objectid="1" transform="0 1 0 1 0 0 0 0 1 5 6 7"/>)");
  const Scan scan = read(package(root));
  EXPECT_EQ(scan.format, "3MF");
  EXPECT_EQ(scan.unit_m, 1e-3);
  ASSERT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.positions[1], Eigen::Vector3d(5, 7, 7));
  EXPECT_EQ(scan.positions[3], Eigen::Vector3d(5, 6, 10.5));
  // The transform is a reflection: its windings are restored.
  EXPECT_EQ(scan.triangles.at(0), (Triangle{0, 1, 2}));
  EXPECT_EQ(read(package(root, true)).positions.size(), 4U);
}

TEST_F(ThreeMfTest, ReadsUnitAfterLongComment) {
  const std::string comment = "<!-- <model unit=\"foot\"> " + std::string(300000, 'x') + " -->";
  const std::string build = R"(<item objectid="1"/>)";
  EXPECT_EQ(read(package(model(object("1", kMesh), build, R"(unit="inch")", comment))).unit_m,
            0.0254);
  EXPECT_EQ(read(package(model(object("1", kMesh), build, ""))).unit_m, 1e-3);
  expect_parts(refusal_of(package(model(object("1", kMesh), build, R"(unit="parsec")"))),
               "\"parsec\"");
}

const std::string kProduction =
    R"(unit="millimeter" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p")";

std::string production(const std::string& part, const std::string& path = "/3D/Objects/a.model") {
  const std::string root = model(
      object("2", "<components><component p:path=\"" + path +
                      R"(" objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 20"/></components>)"),
      R"(<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 100 0"/>)", kProduction);
  return ZipWriter()
      .add("_rels/.rels", kRelations)
      .add("3D/Objects/a.model", part)
      .add("3D/3dmodel.model", root)
      .bytes();
}

TEST_F(ThreeMfTest, ReadsPartsInSeparateFiles) {
  const Scan scan = read(production(model(object("1", kMesh), "")));
  ASSERT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.positions[2], Eigen::Vector3d(0, 104, 40));
  EXPECT_EQ(scan.triangles.size(), 4U);
  // A part of another unit.
  const Scan inches = read(production(model(object("1", kMesh), "", R"(unit="inch")")));
  EXPECT_NEAR(inches.positions.at(2).y(), 100 + 2 * 2 * 25.4, 1e-9);
  expect_parts(refusal_of(production(model(object("1", kMesh), ""), "/3D/b.model"), "a.3mf"),
               "a.3mf", "part \"3D/b.model\" is missing");
  expect_parts(refusal_of(production(model(object("7", kMesh), ""))), "has no object \"1\"");
}

TEST_F(ThreeMfTest, NamesOtherRequiredExtensions) {
  const std::string attributes =
      R"(xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02" requiredextensions="b")";
  expect_parts(
      refusal_of(package(model(object("1", kMesh), R"(<item objectid="1"/>)", attributes))),
      "requires the extension", "beamlattice");
}

TEST_F(ThreeMfTest, RefusesDamage) {
  const std::string item = R"(<item objectid="1"/>)";
  expect_parts(refusal_of(package(model(object("1", kMesh), ""))), "its build refers to no object");
  expect_parts(refusal_of(package(model(object("1", ""), item))), "no points and no faces");
  expect_parts(refusal_of(package(model(object("1", kMesh), R"(<item objectid="4"/>)"))),
               "has no object \"4\"");
  const std::string loop =
      object("1", R"(<components><component objectid="1"/></components>)" + kMesh);
  expect_parts(refusal_of(package(model(loop, item))), "too deeply");
  std::string word = model(object("1", kMesh), item);
  word.replace(word.find("x=\"1\""), 5, "x=\"l\"");
  expect_parts(refusal_of(package(word)), "\"l\" is not a coordinate");
  const std::string whole = model(object("1", kMesh), item);
  expect_parts(refusal_of(package(whole.substr(0, whole.size() / 2))), "was cut off");
  std::string wrong = whole;
  wrong.replace(wrong.find("v3=\"1\""), 6, "v3=\"8\"");
  const Scan scan = read(package(wrong));
  EXPECT_EQ(scan.triangles.size(), 3U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "1 triangles were dropped");
}

TEST_F(ThreeMfTest, RefusesObjectsThatAreMixed) {
  const std::string item = R"(<item objectid="1"/>)";
  expect_parts(refusal_of(package(model(object("1", kMesh) + object("1", kMesh), item))),
               "two objects with the id \"1\"");
  expect_parts(refusal_of(package(model(object("1", kMesh + kMesh), item))),
               "object \"1\" has two meshes");
}

TEST_F(ThreeMfTest, NamesShapesThatAreNotMeshes) {
  std::string lattice = kMesh;
  lattice.replace(lattice.find("</mesh>"), 7, "<b:beamlattice radius='1'/></mesh>");
  const std::string item = R"(<item objectid="1"/>)";
  const Scan scan = read(package(model(object("1", lattice), item)));
  EXPECT_EQ(scan.positions.size(), 4U);
  expect_parts(scan.warnings.at(0), "not meshes were left out: 1 beamlattice.");
  expect_parts(refusal_of(package(model(object("1", "<v:levelset/>"), item))), "no points",
               "1 levelset");
}

/// A number is read whole or refused: its beginning would be another number.
TEST_F(ThreeMfTest, RefusesTextAfterNumbers) {
  const auto refused = [this](const std::string& from, const std::string& to, bool stored) {
    std::string root = model(object("1", kMesh),
                             R"(<item objectid="1" transform=" 1 0 0 0 1 0 0 0 1 12.7 0 0 "/>)");
    root.replace(root.find(from), from.size(), to);
    // A document type makes the reader parse the document as a whole.
    if (stored) root.replace(root.find("<model "), 7, "<!DOCTYPE model><model ");
    return refusal_of(package(root), "a.3mf");
  };
  for (const bool whole : {false, true}) {
    const std::string comma = refused("y=\"2\"", "y=\"2,5\"", whole);
    expect_parts(comma, "a.3mf", "part \"3D/3dmodel.model\"", "\"2,5\" is not a coordinate");
    expect_parts(comma, "vertex 2, which needs a decimal point");
    expect_parts(refused("x=\"1\"", "x=\"0x1\"", whole), "\"0x1\" is not a coordinate of vertex 1");
    expect_parts(refused("12.7", "12,7", whole), "\"12,7\" is not a number of a transform");
    expect_parts(refused("12.7", "12.7 3", whole), "a transform has 13 numbers, not 12");
    expect_parts(refused("12.7", "", whole), "a transform has 11 numbers, not 12");
  }
  std::string spaced = model(object("1", kMesh), R"(<item objectid="1"/>)");
  spaced.replace(spaced.find("x=\"1\""), 5, "x=\" 1\t\"");
  EXPECT_EQ(read(package(spaced)).positions.at(1), Eigen::Vector3d(1, 0, 0));
  // The index of a point is a whole number, too.
  std::string index = model(object("1", kMesh), R"(<item objectid="1"/>)");
  index.replace(index.find("v3=\"1\""), 6, "v3=\"1.9\"");
  const Scan scan = read(package(index));
  EXPECT_EQ(scan.triangles.size(), 3U);
  expect_parts(scan.warnings.at(0), "1 triangles were dropped");
}

TEST_F(ThreeMfTest, LocatesMalformedXml) {
  std::string word = model(object("1", kMesh), R"(<item objectid="1"/>)");
  const std::size_t place = word.find("<triangle ");
  word.replace(place, 9, "<triangle<");
  expect_parts(refusal_of(package(word), "a.3mf"), "a.3mf", "part \"3D/3dmodel.model\"",
               "byte " + std::to_string(place + 10));
  const std::string deep = model(object("1", std::string(40000, '[') + kMesh), "");
  std::string tags;
  for (const char c : deep) tags += c == '[' ? std::string("<g>") : std::string(1, c);
  expect_parts(refusal_of(package(tags)), "part \"3D/3dmodel.model\"", "byte ");
  std::string closed;
  for (int i = 0; i < 40000; ++i) closed += "<g>";
  for (int i = 0; i < 40000; ++i) closed += "</g>";
  expect_parts(refusal_of(package(model(closed + object("1", kMesh), ""))), "is too large: byte ",
               "more than 64 deep");
  expect_parts(refusal_of(package("<other/>")), "has no element \"model\"");
  const std::string relations = ZipWriter()
                                    .add("_rels/.rels", "<Relationships><Relationship")
                                    .add("3D/3dmodel.model", word)
                                    .bytes();
  expect_parts(refusal_of(relations), "part \"_rels/.rels\"", "byte ");
}

TEST_F(ThreeMfTest, ReadsPrefixesAndEscapedPaths) {
  std::string root =
      model("<m:object id=\"a&amp;b\">" + kMesh + "</m:object>", "<item objectid=\"a&#38;b\"/>");
  root.replace(root.find("<model"), 6, "<c:model");
  root.replace(root.find("</model>"), 8, "</c:model>");
  EXPECT_EQ(read(package(root)).positions.size(), 4U);
  const std::string part = model(object("1", kMesh), "");
  const std::string bytes =
      ZipWriter()
          .add("_rels/.rels", kRelations)
          .add("3D/a&b.model", part)
          .add("3D/3dmodel.model",
               model("", R"(<item p:path="/3D/a&amp;b.model" objectid="1"/>)", kProduction))
          .bytes();
  EXPECT_EQ(read(bytes).positions.size(), 4U);
}

/// A model in which a text is replaced everywhere.
std::string with(const std::string& from, const std::string& to) {
  std::string root = model(object("1", kMesh), R"(<item objectid="1"/>)");
  for (std::size_t at = root.find(from); at != std::string::npos;
       at = root.find(from, at + to.size())) {
    root.replace(at, from.size(), to);
  }
  return root;
}

/// Expects the points and triangles of kMesh.
void expect_mesh(const Scan& scan, const std::string& form) {
  EXPECT_EQ(scan.positions.size(), 4U) << form;
  EXPECT_EQ(scan.positions.at(1), Eigen::Vector3d(1, 0, 0)) << form;
  EXPECT_EQ(scan.triangles.size(), 4U) << form;
  EXPECT_EQ(scan.triangles.at(3), (Triangle{1, 2, 3})) << form;
}

/// Documents that are read while they are unpacked, and others that are read as a whole.
TEST_F(ThreeMfTest, ReadsMeshesInAllForms) {
  const std::string forms[] = {
      with("<vertex ", "\r\n\t<vertex\n"),
      with("/><triangle", "></triangle><!-- <vertex/> > --><triangle"),
      with("<vertex ", "<v:vertex w='>' v:w=\"\" "),
      with("<triangle ", "<?pi > ?><other a='1'/><triangle "),
      with("<mesh>", "<mesh><metadata><vertices/></metadata>"),
      with("<resources>",
           "<resources><m:colorgroup id=\"7\"><m:color color=\"#000\"/>"
           "</m:colorgroup><![CDATA[<vertices>]]>"),
      with("<model ", "<!DOCTYPE model [<!ENTITY e 'x'>]><model "),
      with("x=\"1\"", "x=\"&#49;\""),
      with("<vertex ", "<other><vertex/></other><vertex "),
      with("<mesh>", "<mesh><vertices>0</vertices>"),
  };
  for (const std::string& form : forms) {
    for (const bool stored : {false, true}) expect_mesh(read(package(form, stored)), form);
  }
}

TEST_F(ThreeMfTest, ReadsWideCharacters) {
  std::string wide("\xFF\xFE", 2);
  for (const char c : model(object("1", kMesh), R"(<item objectid="1"/>)")) wide += {c, '\0'};
  EXPECT_EQ(read(package(wide)).positions.size(), 4U);
}

TEST_F(ThreeMfTest, LocatesErrorsBesideMeshes) {
  std::string root = model(object("1", kMesh), R"(<item objectid="1"/>)");
  const std::size_t place = root.find("</build>");
  root.replace(place, 8, "</built>");
  expect_parts(refusal_of(package(root)), "byte " + std::to_string(place + 2));
  for (const char* const bad :
       {"<vertex x='1' y='2' z='3'></vertices>", "<vertex x=1/>", "<vertex x='1' y='2' z='3'",
        "<!-- ", "<![CDATA[ ]]> </vertex>", "<vertex x='1' y='2' z='3'/"}) {
    std::string mesh = kMesh;
    mesh.insert(mesh.find("<vertex "), bad);
    const std::string document = model(object("1", mesh), R"(<item objectid="1"/>)");
    expect_parts(refusal_of(package(document)), "part \"3D/3dmodel.model\"", "byte ");
  }
}

#ifndef TACTREE_SANITIZED  // AddressSanitizer needs all addresses
/// A document tree of this mesh would take three times as much.
TEST_F(ThreeMfTest, TakesLittleMoreMemoryThanMesh) {
  constexpr int kVertices = 200'000;
  std::string mesh = "<mesh><vertices>";
  for (int i = 0; i < kVertices; ++i) {
    mesh += "<vertex x=\"" + std::to_string(i % 1000) + "\" y=\"" + std::to_string(i / 1000) +
            "\" z=\"0\"/>";
  }
  mesh += "</vertices><triangles>";
  for (int i = 0; i < 2 * kVertices; ++i) {
    mesh += "<triangle v1=\"" + std::to_string(i % kVertices) + "\" v2=\"" +
            std::to_string((i + 1) % kVertices) + "\" v3=\"" + std::to_string((i + 7) % kVertices) +
            "\"/>";
  }
  mesh += "</triangles></mesh>";
  ReadOptions options;
  options.child_memory_bytes = 160ULL << 20;
  const Scan scan = read_scan(
      write("large.3mf", package(model(object("1", mesh), R"(<item objectid="1"/>)"), true)),
      options);
  EXPECT_EQ(scan.positions.size(), std::size_t{kVertices});
  EXPECT_EQ(scan.triangles.size(), 2 * std::size_t{kVertices});
}
#endif

TEST_F(ThreeMfTest, ReadsArchivesWithLongSizes) {
  const std::string root = model(object("1", kMesh), R"(<item objectid="1"/>)");
  const std::string bytes =
      ZipWriter(false, true).add("_rels/.rels", kRelations).add("3D/3dmodel.model", root).bytes();
  EXPECT_EQ(read(bytes).positions.size(), 4U);
}

TEST_F(ThreeMfTest, RefusesDamagedArchives) {
  const std::string whole = package(model(object("1", kMesh), R"(<item objectid="1"/>)"));
  for (std::size_t length = 200; length < whole.size(); length += whole.size() / 12) {
    expect_parts(refusal_of(whole.substr(0, length), "a.3mf"), "a.3mf", "zip archive");
  }
  std::string flipped = whole;
  flipped[whole.find("3D/3dmodel.model") + 200] ^= 0x10;
  expect_parts(refusal_of(flipped), "zip archive is damaged");
  // A size that 100 bytes cannot have.
  std::string large = whole;
  const std::size_t entry = large.rfind("3D/3dmodel.model") - 46;
  large.replace(entry + 24, 4, test::little(0x7fffffff, 4));
  expect_parts(refusal_of(large), "states a size that its bytes cannot have");
}

}  // namespace
}  // namespace tactree::builder
