#include <algorithm>
#include <cmath>
#include <limits>

#include "e57_writer.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using namespace tactree::test;
using Colour = std::array<std::uint8_t, 3>;

class E57Test : public TestFiles {
 protected:
  Scan read_scans(const std::vector<E57TestScan>& scans) { return read(e57_file(scans)); }
  std::string refusal_of_scans(const std::vector<E57TestScan>& scans) {
    return refusal_of(e57_file(scans), "a.e57");
  }
};

/// `count` points at (i, 0.5 i, -i).
E57TestScan points_on_line(int count) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  for (int i = 0; i < count; ++i) {
    x.push_back(i);
    y.push_back(0.5 * i);
    z.push_back(-i);
  }
  return {{e57_double("cartesianX", x), e57_double("cartesianY", y), e57_double("cartesianZ", z)},
          "",
          61,
          ""};
}

void expect_line(const Scan& scan, int count) {
  ASSERT_EQ(scan.positions.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(scan.positions[static_cast<std::size_t>(i)], Vector3d(i, 0.5 * i, -i)) << i;
  }
}

/// Replaces bytes of the first page and corrects its checksum.
template <typename T>
std::string patched_page(std::string file, std::size_t at, T value) {
  return e57_resealed(file.replace(at, sizeof value, bytes_of(value)));
}

TEST_F(E57Test, ReadsAllTypesAcrossPackets) {
  std::vector<double> x;
  std::vector<float> y;
  std::vector<std::int64_t> z;
  constexpr std::int64_t kStep = 3'000'000'007;
  for (int i = 0; i < 100; ++i) {
    x.push_back(1.0 / (i + 1));
    y.push_back(0.25F * static_cast<float>(i));
    z.push_back(-5'000'000'000 + i * kStep);
  }
  const E57TestScan scan = {
      {e57_double("cartesianX", x), e57_single("cartesianY", y),
       e57_integer("cartesianZ", -5'000'000'000, 400'000'000'000, z, R"(scale="0.5" offset="7")")},
      "",
      5,
      ""};
  const Scan result = read_scans({scan});
  EXPECT_EQ(result.format, "E57");
  EXPECT_EQ(result.unit_m, 1.0);
  EXPECT_TRUE(result.warnings.empty());
  ASSERT_EQ(result.positions.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(result.positions[i],
              Vector3d(x[i], static_cast<double>(y[i]), 7.0 + 0.5 * static_cast<double>(z[i])));
  }
}

TEST_F(E57Test, ReadsIntegersOfEveryWidth) {
  for (unsigned bits = 0; bits <= 64; ++bits) {
    const bool whole = bits == 64;
    const std::int64_t low = whole ? std::numeric_limits<std::int64_t>::min() : -3;
    const std::int64_t high = whole ? std::numeric_limits<std::int64_t>::max()
                                    : static_cast<std::int64_t>(static_cast<std::uint64_t>(low) +
                                                                ((std::uint64_t{1} << bits) - 1));
    const std::int64_t middle = bits == 0 ? low : low / 2 + high / 2;
    E57TestScan scan = {{e57_integer("cartesianX", low, high, {low, high, middle, high, low}),
                         e57_integer("cartesianY", 7, 7, {7, 7, 7, 7, 7}),
                         e57_single("cartesianZ", {0, 1, 2, 3, 4})},
                        "",
                        3,
                        ""};
    ASSERT_EQ(scan.columns[0].bits, bits);
    const Scan result = read_scans({scan});
    ASSERT_EQ(result.positions.size(), 5U) << bits;
    EXPECT_EQ(result.positions[0], Vector3d(static_cast<double>(low), 7, 0)) << bits;
    EXPECT_EQ(result.positions[1], Vector3d(static_cast<double>(high), 7, 1)) << bits;
    EXPECT_EQ(result.positions[2], Vector3d(static_cast<double>(middle), 7, 2)) << bits;
    EXPECT_EQ(result.positions[4], Vector3d(static_cast<double>(low), 7, 4)) << bits;
  }
}

TEST_F(E57Test, ConvertsSphericalCoordinates) {
  const double right_angle = std::acos(0.0);
  const Scan scan = read_scans({{{e57_double("sphericalRange", {2, 3, 4, 5}),
                                  e57_double("sphericalAzimuth", {0, right_angle, 0, 1}),
                                  e57_double("sphericalElevation", {0, 0, right_angle, 0}),
                                  e57_integer("sphericalInvalidState", 0, 2, {0, 0, 0, 1})},
                                 "",
                                 7,
                                 ""}});
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_LT((scan.positions[0] - Vector3d(2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((scan.positions[1] - Vector3d(0, 3, 0)).norm(), 1e-12);
  EXPECT_LT((scan.positions[2] - Vector3d(0, 0, 4)).norm(), 1e-12);
  EXPECT_EQ(scan.dropped.at("not_measured"), 1U);
}

TEST_F(E57Test, OmitsInvalidPoints) {
  E57TestScan scan = points_on_line(4);
  scan.columns.push_back(e57_integer("cartesianInvalidState", 0, 2, {0, 1, 0, 2}));
  const Scan result = read_scans({scan});
  ASSERT_EQ(result.positions.size(), 2U);
  EXPECT_EQ(result.positions[1], Vector3d(2, 1, -2));
  EXPECT_EQ(result.dropped.at("not_measured"), 2U);
  scan.columns.back() = e57_single("cartesianInvalidState", {1, 1, 1, 1});
  expect_parts(refusal_of_scans({scan}), "a.e57", "none of the 4 points is valid");
}

TEST_F(E57Test, PlacesScansByPose) {
  E57TestScan first = points_on_line(3);
  // A turn by 90 degrees about z, not normalised.
  first.xml = e57_pose("2 0 0 2", "10 20 30");
  E57TestScan second = points_on_line(2);
  second.xml = e57_pose("1 0 0 0", "0 0 5");
  const Scan scan = read_scans({first, second, points_on_line(1)});
  ASSERT_EQ(scan.positions.size(), 6U);
  EXPECT_LT((scan.positions[2] - Vector3d(9, 22, 28)).norm(), 1e-12);
  EXPECT_EQ(scan.positions[4], Vector3d(1, 0.5, 4));
  ASSERT_EQ(scan.poses.size(), 3U);
  EXPECT_EQ(scan.poses[0].position, Vector3d(10, 20, 30));
  EXPECT_TRUE(scan.poses[0].sure);
  EXPECT_EQ(scan.poses[1].position, Vector3d(0, 0, 5));
  EXPECT_EQ(scan.poses[1].first_point, 3U);
  EXPECT_TRUE(scan.poses[2].position.hasNaN());
  EXPECT_EQ(scan.poses[2].first_point, 5U);
}

TEST_F(E57Test, DoubtsPoseAtOrigin) {
  E57TestScan scan = points_on_line(3);
  scan.xml = e57_pose("1 0 0 0", "0 0 0");
  const Scan result = read_scans({scan});
  ASSERT_EQ(result.poses.size(), 1U);
  EXPECT_FALSE(result.poses[0].sure);
  EXPECT_TRUE(read_scans({points_on_line(3)}).poses.empty());
}

TEST_F(E57Test, TurnsNormalsWithPose) {
  E57TestScan scan = points_on_line(2);
  scan.columns.push_back(e57_single("nor:normalX", {1, 0}));
  scan.columns.push_back(e57_single("nor:normalY", {0, 0}));
  scan.columns.push_back(e57_single("nor:normalZ", {0, 1}));
  scan.xml = e57_pose("0.5 0.5 0.5 0.5", "0 0 0");  // x to y, y to z, z to x
  const Scan result = read_scans({scan});
  ASSERT_EQ(result.normals.size(), 2U);
  EXPECT_LT((result.normals[0] - Vector3f(0, 1, 0)).norm(), 1e-6F);
  EXPECT_LT((result.normals[1] - Vector3f(1, 0, 0)).norm(), 1e-6F);
}

TEST_F(E57Test, ScalesColoursOfEachRange) {
  E57TestScan words = points_on_line(3);
  E57TestScan floats = points_on_line(3);
  E57TestScan limited = points_on_line(3);
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
    words.columns.push_back(e57_integer(name, 0, 65535, {0, 32896, 65535}));
    floats.columns.push_back(e57_single(name, {0, 0.5F, 1}));
    limited.columns.push_back(e57_integer(name, 0, 65535, {0, 50, 100}));
    limited.xml += std::string("<") + name + "Maximum type=\"Integer\">100</" + name + "Maximum>";
  }
  limited.xml = "<colorLimits type=\"Structure\">" + limited.xml + "</colorLimits>";
  for (const E57TestScan& scan : {words, floats, limited}) {
    const Scan result = read_scans({scan});
    ASSERT_EQ(result.colours.size(), 3U);
    EXPECT_EQ(result.colours[0], (Colour{0, 0, 0}));
    EXPECT_EQ(result.colours[1], (Colour{128, 128, 128}));
    EXPECT_EQ(result.colours[2], (Colour{255, 255, 255}));
  }
  const Scan mixed = read_scans({words, points_on_line(2)});
  EXPECT_TRUE(mixed.colours.empty());
  ASSERT_EQ(mixed.warnings.size(), 1U);
  expect_parts(mixed.warnings[0], "1 of 2 scans", "colours");
}

TEST_F(E57Test, LargestColourOfAScanDecidesItsRange) {
  const auto coloured = [](const E57Column& column, const std::string& limit) {
    E57TestScan scan = points_on_line(3);
    for (const std::string name : {"colorRed", "colorGreen", "colorBlue"}) {
      scan.columns.push_back(column);
      scan.columns.back().name = name;
      if (limit.empty()) continue;
      scan.xml += "<" + name + "Maximum type=\"Float\">" + limit + "</" + name + "Maximum>";
    }
    if (!limit.empty()) scan.xml = "<colorLimits type=\"Structure\">" + scan.xml + "</colorLimits>";
    return scan;
  };
  const E57TestScan bytes = coloured(e57_single("", {0, 128, 255}), "");
  const E57TestScan one = coloured(e57_integer("", 0, 255, {0, 128, 255}), "1");
  const E57TestScan narrow = coloured(e57_integer("", 0, 65535, {0, 128, 255}), "");
  const E57TestScan words = coloured(e57_double("", {0, 32896, 65535}), "");
  const E57TestScan unit = coloured(e57_double("", {0, 0.5, 1}), "1");
  const Scan result = read_scans({unit, bytes, one, words, narrow, unit});
  ASSERT_EQ(result.colours.size(), 18U);
  for (std::size_t i = 0; i < result.colours.size(); ++i) {
    const std::uint8_t channel = i % 3 == 0 ? 0 : i % 3 == 1 ? 128 : 255;
    EXPECT_EQ(result.colours[i], (Colour{channel, channel, channel})) << i;
  }
}

TEST_F(E57Test, SkipsOtherFieldsAndText) {
  E57TestScan scan = points_on_line(40);
  E57Column text{"las:note", "type=\"String\"", 8, {}};
  E57Column intensity{"intensity", "type=\"Float\"", 64, {}};
  for (int i = 0; i < 40; ++i) {
    text.numbers.push_back('x');
    intensity.numbers.push_back(~0ULL);
  }
  scan.columns.insert(scan.columns.begin(), {text, intensity});
  expect_line(read_scans({scan}), 40);
}

TEST_F(E57Test, ProgressRises) {
  std::vector<double> fractions;
  ReadOptions options;
  options.progress = [&](double fraction) { fractions.push_back(fraction); };
  E57TestScan scan = points_on_line(50'000);
  scan.packet_bytes = 16'000;
  EXPECT_EQ(read_scan(write("a.e57", e57_file({scan, scan})), options).positions.size(), 100'000U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.size(), 3U);
}

TEST_F(E57Test, RefusesFilesWithoutPoints) {
  E57TestScan none = points_on_line(0);
  expect_parts(refusal_of_scans({}), "a.e57", "no point", "declares no scan");
  expect_parts(refusal_of_scans({none, none}), "a.e57", "no point", "all scans (2) are empty");
  expect_line(read_scans({none, points_on_line(2)}), 2);
}

TEST_F(E57Test, WrongChecksumNamesPage) {
  const std::string file = e57_file({points_on_line(300)});
  ASSERT_GE(file.size(), 6 * 1024U);
  for (std::size_t page = 0; page < file.size() / 1024; ++page) {
    for (const std::size_t at : {10UL, 1019UL, 1023UL}) {
      std::string damaged = file;
      damaged[page * 1024 + at] = static_cast<char>(damaged[page * 1024 + at] ^ 4);
      expect_parts(refusal_of(damaged, "bad.e57"), "bad.e57",
                   "page " + std::to_string(page + 1) + " (byte " + std::to_string(page * 1024),
                   "checksum");
    }
  }
}

TEST_F(E57Test, RefusesTruncatedFile) {
  const std::string file = e57_file({points_on_line(100)});
  expect_line(read(file), 100);
  for (std::size_t length = 8; length < file.size(); length += 97) {
    expect_parts(refusal_of(std::string_view(file).substr(0, length), "cut.e57"), "cut.e57");
  }
  expect_parts(refusal_of(file.substr(0, file.size() - 1)), "the file ends too early");
}

TEST_F(E57Test, ChecksDeclaredCounts) {
  E57TestScan scan = points_on_line(3);
  scan.count = "4";
  expect_parts(refusal_of_scans({scan}), "scan 1", "4 points are declared", "only 3 are present");
  scan.count = "4294967296";
  expect_parts(refusal_of_scans({scan}), "scan 1", "4294967296 points", "there is room for");
  scan.count = "9223372036854775807";
  expect_parts(refusal_of_scans({points_on_line(1), scan}), "scan 2", "there is room for");
  scan.count = "-1";
  expect_parts(refusal_of_scans({scan}), "scan 1", "recordCount", "\"-1\"");
  E57TestScan constant = {
      {e57_integer("cartesianX", 1, 1, {1}), e57_integer("cartesianY", 1, 1, {1}),
       e57_integer("cartesianZ", 1, 1, {1})},
      "",
      7,
      "1000000000000"};
  expect_parts(refusal_of_scans({constant}), "there is room for");
}

TEST_F(E57Test, ChecksSizesAndPlaces) {
  const std::string file = e57_file({points_on_line(3)});
  const auto huge = std::uint64_t{1} << 62;
  expect_parts(refusal_of(patched_page(file, 8, 2U)), "header", "version 2");
  expect_parts(refusal_of(patched_page(file, 16, huge)), "header", "ends too early");
  expect_parts(refusal_of(patched_page(file, 24, huge)), "descriptions of the scans", "no data");
  expect_parts(refusal_of(patched_page(file, 24, std::uint64_t{1021})), "byte 1021", "no data");
  expect_parts(refusal_of(patched_page(file, 32, huge)), "header", "XML section", "too large");
  expect_parts(refusal_of(patched_page(file, 40, std::uint64_t{0})), "header", "pages of 0 bytes");
  // The header of the section is at byte 48, its first packet (16 bytes, then 4) at 80.
  expect_parts(refusal_of(patched_page(file, 48, '\2')), "scan 1", "header of a section");
  expect_parts(refusal_of(patched_page(file, 56, huge)), "scan 1", "its points take");
  expect_parts(refusal_of(patched_page(file, 64, huge)), "points of scan 1", "no data");
  expect_parts(refusal_of(patched_page(file, 64, std::uint64_t{0})), "first packet is outside");
  expect_parts(refusal_of(patched_page(file, 80, '\x07')), "scan 1", "unknown type 7");
  expect_parts(refusal_of(patched_page(file, 82, std::uint16_t{0xffff})), "a packet",
               "65536 bytes");
  expect_parts(refusal_of(patched_page(file, 102, std::uint16_t{3})), "a packet", "4 bytes");
  expect_parts(refusal_of(patched_page(file, 104, std::uint16_t{9})), "a packet has 9 streams",
               "3 fields");
  expect_parts(refusal_of(patched_page(file, 106, std::uint16_t{0xffff})), "exceeds its packet");
}

TEST_F(E57Test, RefusesInconsistentXmlSection) {
  const auto with_xml = [&](const std::string& from, const std::string& to) {
    std::string file = e57_file({points_on_line(3)});
    std::string logical;
    for (std::size_t at = 0; at < file.size(); at += 1024) logical += file.substr(at, 1020);
    const std::size_t place = logical.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    logical.replace(place, from.size(), to);
    return refusal_of(e57_pages(logical), "x.e57");
  };
  expect_parts(with_xml("<data3D", "<<<<<<<"), "x.e57", "XML section");
  expect_parts(with_xml("<e57Root type=\"Structure\"", "<e57Boot type=\"Structure\""), "x.e57",
               "XML section");
  expect_parts(with_xml("cartesianX", "cartesianW"), "scan 1", "neither cartesian nor spherical");
  expect_parts(with_xml("\"Float\"", "\"Flow_\""), "scan 1", "\"Flow_\"", "cartesianX");
  E57TestScan scan = points_on_line(2);
  scan.columns[0].attributes = "type=\"Integer\" minimum=\"5\" maximum=\"4\"";
  expect_parts(refusal_of_scans({scan}), "scan 1", "maximum of \"cartesianX\"");
  scan.columns[0].attributes = "type=\"Integer\" minimum=\"five\"";
  expect_parts(refusal_of_scans({scan}), "scan 1", "minimum", "\"five\"");
  scan = points_on_line(2);
  scan.xml = e57_pose("0 0 0 0", "0 0 0");
  expect_parts(refusal_of_scans({scan}), "scan 1", "quaternion");
  scan.xml = e57_pose("1 0 0 0", "inf 0 0");
  expect_parts(refusal_of_scans({scan}), "scan 1", "translation");
  for (const char* translation : {"one 0 0", "0 one 0", "0 0 one"}) {
    scan.xml = e57_pose("1 0 0 0", translation);
    expect_parts(refusal_of_scans({scan}), "scan 1", "\"one\"");
  }
}

}  // namespace
}  // namespace tactree::builder
