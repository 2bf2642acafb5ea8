// AMF: units, constellations, volumes that are not the body, colours.

#include "mesh_writers.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Rgb = std::array<std::uint8_t, 3>;

std::string amf_vertex(const std::string& x, const std::string& y, const std::string& z,
                       const std::string& more = "") {
  return "<vertex><coordinates><x>" + x + "</x><y>" + y + "</y><z>" + z + "</z></coordinates>" +
         more + "</vertex>";
}

std::string amf_triangle(int a, int b, int c) {
  return "<triangle><v1>" + std::to_string(a) + "</v1><v2>" + std::to_string(b) + "</v2><v3>" +
         std::to_string(c) + "</v3></triangle>";
}

/// An object with the points (1, 2, 3), (4, 2, 3) and (1, 5, 3).
std::string amf_object(const std::string& id, const std::string& volume = amf_triangle(0, 1, 2),
                       const std::string& vertices = "") {
  return "<object id=\"" + id + "\"><mesh><vertices>" + amf_vertex("1", "2", "3") +
         amf_vertex("4", "2", "3") + amf_vertex(" 1 ", "5", "+3") + vertices +
         "</vertices><volume>" + volume + "</volume></mesh></object>";
}

std::string amf(const std::string& content, const std::string& attributes = "") {
  return "<?xml version=\"1.0\"?><amf" + attributes + ">" + content + "</amf>";
}

std::string constellation(const std::string& instance, const std::string& id = "9",
                          const std::string& object = "1") {
  return "<constellation id=\"" + id + "\"><instance objectid=\"" + object + "\">" + instance +
         "</instance></constellation>";
}

class Amf : public TestFiles {
 protected:
  Scan placed(const std::string& instance) {
    return read(amf(amf_object("1") + constellation(instance)));
  }
};

TEST_F(Amf, ReadsUnitInAnyCase) {
  const auto unit = [this](const std::string& name) {
    return read(amf(amf_object("1"), " unit=\"" + name + "\"")).unit_m;
  };
  EXPECT_EQ(read(amf(amf_object("1"))).unit_m, 1e-3);
  EXPECT_EQ(unit("millimeter"), 1e-3);
  EXPECT_EQ(unit("Inch"), 0.0254);
  EXPECT_EQ(unit("METER"), 1.0);
  expect_parts(refusal_of(amf(amf_object("1"), " unit=\"parsec\""), "a.amf"), "a.amf",
               "its unit \"parsec\" is not known");
}

TEST_F(Amf, ReadsFileThatIsPacked) {
  const std::string text = amf(amf_object("1"), " unit=\"inch\"");
  const Scan scan = read(test::ZipWriter().add("Part.AMF", text).bytes());
  EXPECT_EQ(scan.format, "AMF");
  EXPECT_EQ(scan.unit_m, 0.0254);
  EXPECT_EQ(scan.positions.size(), 3U);
  expect_parts(refusal_of(test::ZipWriter().add("a.amf", text).add("b.amf", text).bytes()),
               "an archive of 2 AMF files, not of one");
}

TEST_F(Amf, PlacesObjectsOfConstellation) {
  const std::pair<std::string, Eigen::Vector3d> places[] = {
      {"", {4, 2, 3}},
      {"<deltax>100</deltax><rx>0</rx><ry>0</ry><rz>0</rz>", {104, 2, 3}},
      {"<rx>0</rx><deltay>100</deltay><deltaz>-5</deltaz>", {4, 102, -2}},
      {"<rz>90</rz>", {-2, 4, 3}},
      {"<rx>90</rx>", {4, -3, 2}},
      {"<ry>90</ry>", {3, 2, -4}},
      // Turned about x, then about z, then moved.
      {"<rz>90</rz><deltax>10</deltax><rx>90</rx>", {13, 4, 2}},
      {"<scale>2</scale><scaley>3</scaley>", {8, 12, 6}},
      {"<mirrorx>-1</mirrorx>", {-4, 2, 3}}};
  for (const auto& [instance, place] : places) {
    const Scan scan = placed(instance);
    EXPECT_LT((scan.positions.at(1) - place).norm(), 1e-9) << instance;
  }
  EXPECT_EQ(placed("<mirrorx>-1</mirrorx>").triangles.at(0), (Triangle{0, 2, 1}));
}

TEST_F(Amf, PlacesConstellationsInConstellations) {
  const Scan scan = read(amf(constellation("<deltax>100</deltax>", "8", "9") +
                             constellation("<rz>90</rz>") + amf_object("1")));
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_LT((scan.positions[1] - Eigen::Vector3d(98, 4, 3)).norm(), 1e-9);
  const std::string loop = constellation("", "8", "9") + constellation("", "9", "8");
  expect_parts(refusal_of(amf(amf_object("1") + constellation("", "7", "8") + loop)),
               "nested too deeply");
  expect_parts(refusal_of(amf(amf_object("2") + constellation(""))), "refers to the object \"1\"");
}

TEST_F(Amf, NamesObjectsOutsideOfConstellations) {
  const Scan scan =
      read(amf(amf_object("1") + amf_object("2") + constellation("<deltax>100</deltax>")));
  EXPECT_EQ(scan.positions.size(), 6U);
  expect_parts(scan.warnings.at(0), "1 object outside of the constellations");
  EXPECT_TRUE(read(amf(amf_object("1") + amf_object("2"))).warnings.empty());
}

TEST_F(Amf, RefusesTextThatIsNoNumber) {
  expect_parts(refusal_of(amf(amf_object("1", "", amf_vertex("1", "2,5", "3")))),
               "\"2,5\" is not a coordinate of vertex 3", "decimal point");
  expect_parts(refusal_of(amf(amf_object("1") + constellation("<rz>90deg</rz>"))),
               "\"90deg\" is not a number of an instance");
  expect_parts(refusal_of(amf(amf_object("1") + constellation("<skew>1</skew>"))),
               "the element \"skew\"");
  expect_parts(refusal_of(amf(amf_object("1") + amf_object("1"))), "two objects with the id \"1\"");
  const std::string whole = amf(amf_object("1"));
  expect_parts(refusal_of(whole.substr(0, whole.size() / 2)), "was cut off: byte ");
  expect_parts(refusal_of(amf("<object id=\"1\"/>")), "no points and no faces");
  const Scan scan = read(amf(amf_object("1", amf_triangle(0, 1, 2) + amf_triangle(0, 1, 7))));
  EXPECT_EQ(scan.triangles.size(), 1U);
  expect_parts(scan.warnings.at(0), "1 triangles were dropped");
}

TEST_F(Amf, LeavesOutVolumesThatAreNotTheBody) {
  const auto with = [this](const std::string& start) {
    return read(amf(amf_object(
        "1", amf_triangle(0, 1, 2) + "</volume><volume" + start + amf_triangle(3, 4, 5),
        amf_vertex("90", "0", "0") + amf_vertex("90", "9", "0") + amf_vertex("90", "9", "9"))));
  };
  EXPECT_EQ(with(">").positions.size(), 6U);
  for (const std::string start :
       {" type=\"support\">", "><metadata type=\"slic3r.modifier\">1</metadata>",
        "><metadata type=\"slic3r.volume_type\">SupportBlocker</metadata>"}) {
    const Scan scan = with(start);
    EXPECT_EQ(scan.positions.size(), 3U) << start;
    EXPECT_EQ(scan.triangles.size(), 1U) << start;
    expect_parts(scan.warnings.at(0), "left out: 1 ");
  }
  const Scan hidden =
      read(amf(amf_object("1") +
               constellation("</instance><instance objectid=\"1\"><printable>0</printable>")));
  EXPECT_EQ(hidden.positions.size(), 3U);
  expect_parts(hidden.warnings.at(0), "1 instance that is not printed");
}

TEST_F(Amf, ReadsColoursOfFileOnly) {
  EXPECT_TRUE(read(amf(amf_object("1"))).colours.empty());
  const std::string red = "<color><r>1</r><g>0</g><b>0.2</b></color>";
  const Scan scan = read(amf(amf_object("1", red + amf_triangle(0, 1, 2))));
  ASSERT_EQ(scan.colours.size(), 3U);
  EXPECT_EQ(scan.colours[0], (Rgb{255, 0, 51}));
  EXPECT_TRUE(read(amf(amf_object("1", amf_triangle(1, 2, 3), amf_vertex("9", "9", "9", red))))
                  .colours.empty());
  std::string material = amf("<material id=\"5\">" + red + "</material>" + amf_object("1"));
  material.replace(material.find("<volume>"), 8, "<volume materialid=\"5\">");
  EXPECT_EQ(read(material).colours.at(2), (Rgb{255, 0, 51}));
}

}  // namespace
}  // namespace tactree::builder
