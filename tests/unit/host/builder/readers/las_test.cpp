#include <limits>

#include "las_writer.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Eigen::Vector3d;
using namespace tactree::test;
using Colour = std::array<std::uint8_t, 3>;

class LasTest : public TestFiles {};

LasFile las_points(int minor, int format) {
  LasFile file;
  file.minor = minor;
  file.point_format = format;
  file.points = {
      {{1, 2, 3}, {65535, 257, 0}}, {{-4, 5, 2147483647}, {514, 32896, 1}}, {{0, 0, 0}, {0, 0, 0}}};
  return file;
}

template <typename T>
std::string patched(std::string file, std::size_t at, T value) {
  return file.replace(at, sizeof value, bytes_of(value));
}

TEST_F(LasTest, ReadsEveryPointFormat) {
  for (int format = 0; format <= 10; ++format) {
    for (const int minor : {format < 2 ? 0 : 2, 3, 4}) {
      if (format > 5 && minor < 4) continue;
      LasFile file = las_points(minor, format);
      file.scale = {0.001, 0.5, 2};
      file.offset = {600000, -1, 0};
      file.extra_bytes = static_cast<std::size_t>(format % 3);
      const Scan scan = read(las_file(file));
      EXPECT_EQ(scan.format,
                "LAS 1." + std::to_string(minor) + " point format " + std::to_string(format));
      ASSERT_EQ(scan.positions.size(), 3U);
      EXPECT_EQ(scan.positions[0], Vector3d(1 * 0.001 + 600000, 0, 6));
      EXPECT_EQ(scan.positions[1], Vector3d(-4 * 0.001 + 600000, 1.5, 2.0 * 2147483647));
      EXPECT_FALSE(scan.unit_m.has_value());
      EXPECT_TRUE(scan.warnings.empty());
      const bool colours =
          format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
      ASSERT_EQ(scan.colours.size(), colours ? 3U : 0U) << format;
      if (colours) {
        EXPECT_EQ(scan.colours[0], (Colour{255, 1, 0})) << format;
        EXPECT_EQ(scan.colours[1], (Colour{2, 128, 0})) << format;
      }
    }
  }
}

TEST_F(LasTest, ReadsEightBitColours) {
  LasFile file = las_points(2, 2);
  file.points[0].colour = {255, 128, 0};
  file.points[1].colour = {1, 2, 3};
  Scan scan = read(las_file(file));
  EXPECT_EQ(scan.colours[0], (Colour{255, 128, 0}));
  EXPECT_EQ(scan.colours[1], (Colour{1, 2, 3}));
  file.points[2].colour = {256, 0, 0};  // so all have sixteen
  scan = read(las_file(file));
  EXPECT_EQ(scan.colours[0], (Colour{1, 0, 0}));
  EXPECT_EQ(scan.colours[2], (Colour{1, 0, 0}));
}

TEST_F(LasTest, OmitsWithheldPoints) {
  for (const int format : {1, 7}) {
    LasFile file = las_points(4, format);
    file.points[0].withheld = true;
    file.points[1].synthetic = true;  // of photogrammetry, for example
    const Scan scan = read(las_file(file));
    ASSERT_EQ(scan.positions.size(), 2U);
    EXPECT_EQ(scan.positions[1], Vector3d(0, 0, 0));
    EXPECT_EQ(scan.dropped.at("withheld"), 1U);
    for (LasPoint& point : file.points) point.withheld = true;
    expect_parts(refusal_of(las_file(file), "a.las"), "a.las", "all 3 points", "withheld");
  }
  LasFile old = las_points(0, 1);  // the bit belongs to the class
  old.points[0].withheld = true;
  EXPECT_EQ(read(las_file(old)).positions.size(), 3U);
}

TEST_F(LasTest, ReadsUnitFromKeys) {
  const auto scan_with = [&](std::vector<std::array<std::uint16_t, 2>> keys) {
    LasFile file = las_points(2, 0);
    file.records = las_record("other", 7, "text") + las_geo_keys(keys);
    file.record_count = 2;
    return read(las_file(file));
  };
  EXPECT_EQ(scan_with({{1024, 1}, {3076, 9001}}).unit_m, 1.0);
  EXPECT_EQ(scan_with({{3076, 9002}}).unit_m, 0.3048);
  EXPECT_DOUBLE_EQ(scan_with({{3076, 9003}}).unit_m.value(), 0.3048006096012192);
  EXPECT_EQ(scan_with({{3076, 1025}}).unit_m, 0.001);
  EXPECT_EQ(scan_with({{3076, 9005}}).unit_m, 0.3047972654);
  EXPECT_EQ(scan_with({{1024, 1}, {3072, 25833}}).unit_m, 1.0);  // UTM
  EXPECT_FALSE(scan_with({{3076, 9999}}).unit_m.has_value());
  const Scan mixed = scan_with({{3076, 9001}, {4099, 9002}});  // heights in feet
  EXPECT_EQ(mixed.unit_m, 1.0);
  EXPECT_DOUBLE_EQ(mixed.positions[0].z(), 3 * 0.3048);
  EXPECT_EQ(mixed.positions[0].y(), 2);
  const Scan degrees = scan_with({{1024, 2}});
  ASSERT_EQ(degrees.warnings.size(), 1U);
  expect_parts(degrees.warnings[0], "degrees");
}

TEST_F(LasTest, ReadsUnitOfItsOwnFromKeys) {
  const auto scan_with = [&](std::uint16_t index) {
    LasFile file = las_points(2, 0);
    std::string keys = las_geo_keys({{3076, 32767}, {3077, index}});
    keys.replace(54 + 16 + 2, 2, bytes_of(std::uint16_t{34736}));
    file.records = keys + las_record("LASF_Projection", 34736, bytes_of(7.0) + bytes_of(0.25));
    file.record_count = 2;
    return read(las_file(file));
  };
  EXPECT_EQ(scan_with(1).unit_m, 0.25);
  const Scan missing = scan_with(2);
  EXPECT_FALSE(missing.unit_m.has_value());
  ASSERT_EQ(missing.warnings.size(), 1U);
  expect_parts(missing.warnings[0], "a unit of length of its own", "taken as metres", "--unit");
}

TEST_F(LasTest, WarnsOfUnitsThatItDoesNotKnow) {
  const auto warning_of = [&](std::vector<std::array<std::uint16_t, 2>> keys) {
    LasFile file = las_points(2, 0);
    file.records = las_geo_keys(keys);
    file.record_count = 1;
    const Scan scan = read(las_file(file));
    return scan.warnings.size() == 1 ? scan.warnings[0] : std::to_string(scan.warnings.size());
  };
  expect_parts(warning_of({{1024, 1}, {3072, 2263}}), "EPSG:2263", "metres", "--unit");
  expect_parts(warning_of({{3076, 9999}}), "EPSG:9999", "metres", "--unit");
  expect_parts(warning_of({{3072, 32767}}), "system of its own", "--unit");
  expect_parts(warning_of({{1024, 1}, {4099, 9002}}), "heights in units of 0.3048 m", "--unit");
  expect_parts(warning_of({{3076, 9001}, {4096, 9876}}), "EPSG:9876", "unit of x and y");
  expect_parts(warning_of({{3076, 9001}, {4099, 9999}}), "EPSG:9999", "unit of x and y");
  expect_parts(warning_of({{2048, 4326}}), "degrees");
  EXPECT_EQ(warning_of({{1024, 1}, {3072, 2263}, {3076, 9003}}), "0");
  EXPECT_EQ(warning_of({{1024, 1}, {2048, 4269}, {3072, 26910}, {4096, 5703}}), "0");
  EXPECT_EQ(warning_of({{1024, 3}}), "0");
}

TEST_F(LasTest, ReadsUnitOfHeights) {
  const auto height_with = [&](std::vector<std::array<std::uint16_t, 2>> keys) {
    LasFile file = las_points(2, 0);
    file.records = las_geo_keys(keys);
    file.record_count = 1;
    return read(las_file(file)).positions[0].z();
  };
  EXPECT_DOUBLE_EQ(height_with({{3072, 26910}, {4096, 5703}, {4099, 9003}}), 3 * 1200.0 / 3937.0);
  EXPECT_DOUBLE_EQ(height_with({{3076, 9001}, {4096, 6360}}), 3 * 1200.0 / 3937.0);
  EXPECT_DOUBLE_EQ(height_with({{3076, 9001}, {4096, 5703}}), 3);
  EXPECT_DOUBLE_EQ(height_with({{3076, 9002}, {4096, 5703}}), 3 / 0.3048);
}

TEST_F(LasTest, ReadsUnitFromRecordsBehindThePoints) {
  LasFile file = las_points(4, 6);
  const std::string text = R"(PROJCS["p",UNIT["foot",0.3048]])";
  file.last_records = las_extended_record("other", 2112, "text") +
                      las_extended_record("LASF_Projection", 2112, text);
  file.last_record_count = 2;
  const std::string bytes = las_file(file);
  EXPECT_EQ(read(bytes).unit_m, 0.3048);
  for (std::size_t cut = 1; cut <= file.last_records.size(); ++cut) {
    const Scan scan = read(std::string_view(bytes).substr(0, bytes.size() - cut));
    EXPECT_FALSE(scan.unit_m.has_value());
    ASSERT_EQ(scan.warnings.size(), 1U) << cut;
    expect_parts(scan.warnings[0], "records behind its points", "--unit");
  }
  for (const std::uint64_t begin : {std::uint64_t{0}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    EXPECT_EQ(read(patched(bytes, 235, begin)).positions.size(), 3U);
  }
}

TEST_F(LasTest, UsesTheFormOfCoordinateSystemThatTheHeaderNames) {
  LasFile file = las_points(4, 6);
  file.records = las_record("LASF_Projection", 2112, R"(PROJCS["p",UNIT["foot",0.3048]])") +
                 las_geo_keys({{3076, 9001}});
  file.record_count = 2;
  for (const bool text_rules : {false, true}) {
    file.text_rules = text_rules;
    const Scan scan = read(las_file(file));
    EXPECT_EQ(scan.unit_m, text_rules ? 0.3048 : 1.0);
    ASSERT_EQ(scan.warnings.size(), 1U);
    expect_parts(scan.warnings[0], "different units");
  }
}

TEST_F(LasTest, OmitsNoise) {
  for (const int format : {1, 7}) {
    LasFile file = las_points(4, format);
    file.points[0].kind = 7;
    file.points[1].kind = format == 1 ? 2 : 18;
    const Scan scan = read(las_file(file));
    const std::size_t noise = format == 1 ? 1 : 2;
    EXPECT_EQ(scan.positions.size(), 3 - noise);
    EXPECT_EQ(scan.dropped.at("noise"), noise);
    ASSERT_EQ(scan.notes.size(), 1U);
    expect_parts(scan.notes[0], std::to_string(noise) + " of 3 points", "noise");
    for (LasPoint& point : file.points) point.kind = 7;
    expect_parts(refusal_of(las_file(file), "a.las"), "a.las", "all 3 points", "noise");
  }
  LasFile old = las_points(0, 1);  // its classes are not those of later versions
  old.points[0].kind = 7;
  EXPECT_EQ(read(las_file(old)).positions.size(), 3U);
}

LasFile boxed_points() {
  LasFile file;
  for (std::int32_t i = 0; i < 20; ++i) file.points.push_back({{i, 2 * i, 5}, {}});
  file.box = {19, 0, 38, 0, 5, 5};
  return file;
}

TEST_F(LasTest, WarnsOfPointsOutsideOfTheBoxOfTheHeader) {
  LasFile file = boxed_points();
  EXPECT_TRUE(read(las_file(file)).warnings.empty());
  file.scale[0] = 100;
  const Scan wide = read(las_file(file));
  ASSERT_EQ(wide.warnings.size(), 1U);
  expect_parts(wide.warnings[0], "17 of 20 points", "19 x 38 x 0", "1900 x 38 x 0");
  file = boxed_points();
  file.box = {20, 1, 37, 1, 5, 5};  // rounded
  EXPECT_TRUE(read(las_file(file)).warnings.empty());
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::array<double, 6>& box :
       {std::array<double, 6>{}, {-infinity, infinity, 1, 0, 1, 0}, {0, 1, 0, 1, 0, 1}}) {
    file.box = box;  // never set
    EXPECT_TRUE(read(las_file(file)).warnings.empty());
  }
}

TEST_F(LasTest, RefusesPointsOfWrongBytes) {
  LasFile file = boxed_points();
  for (std::size_t i = 0; i < 5; ++i)
    file.points[3 * i].position[1] = i % 2 == 0 ? -2000000000 : 2000000000;
  expect_parts(refusal_of(las_file(file), "a.las"), "a.las", "5 of 20 points", "box", "copy it");
  file.box = {19, 0, 2e9, -2e9, 5, 5};  // right coordinates
  EXPECT_TRUE(read(las_file(file)).warnings.empty());
}

TEST_F(LasTest, ReadsUnitFromWkt) {
  const auto scan_with = [&](const std::string& text) {
    LasFile file = las_points(4, 6);
    file.records = las_record("LASF_Projection", 2112, text);
    file.record_count = 1;
    return read(las_file(file));
  };
  const std::string degree = R"(GEOGCS["a]",UNIT["degree",0.0174]])";
  EXPECT_EQ(scan_with(R"(PROJCS["p",)" + degree + R"(,UNIT["metre",1,AUTHORITY["E","9"]]])").unit_m,
            1.0);
  const Scan feet = scan_with(R"(COMPD_CS["c",PROJCS["p",)" + degree +
                              R"(,UNIT["foot",0.3048]],VERT_CS["v",UNIT["metre",1]]])");
  EXPECT_EQ(feet.unit_m, 0.3048);
  EXPECT_DOUBLE_EQ(feet.positions[0].z(), 3 / 0.3048);
  EXPECT_EQ(scan_with(R"(PROJCRS["p",CS[Cartesian,2],LENGTHUNIT["metre",1.0]])").unit_m, 1.0);
  EXPECT_EQ(scan_with(R"(LOCAL_CS["l",UNIT["mm",0.001]])").unit_m, 0.001);
  EXPECT_EQ(scan_with(degree).warnings.size(), 1U);
  const Scan heights = scan_with(R"(PROJCS["p",)" + degree +
                                 R"(,UNIT["Meter",1.0]],VERTCS["v",UNIT["Foot_US",0.25]])");
  EXPECT_EQ(heights.unit_m, 1.0);
  EXPECT_DOUBLE_EQ(heights.positions[0].z(), 3 * 0.25);
  EXPECT_EQ(
      scan_with("ProjCRS [\"p\",\n  BASEGEOGCRS[\"b\",ELLIPSOID[\"e\",6,3,LENGTHUNIT[\"m\",1]]],"
                "CS[Cartesian,2],AXIS[\"x\",east,LENGTHUNIT(\"ft\", 0.3048)],USAGE[\"u\","
                "VERTICALEXTENT[0,1,LENGTHUNIT[\"m\",1]]]]")
          .unit_m,
      0.3048);
  const Scan none = scan_with(R"(PROJCS["p",)" + degree + "]");
  EXPECT_FALSE(none.unit_m.has_value());
  ASSERT_EQ(none.warnings.size(), 1U);
  expect_parts(none.warnings[0], "without a unit of length", "--unit");
  for (const std::string bad : {"", "PROJCS[", "PROJCS[\"", "PROJCS[UNIT[", "PROJCS[UNIT[\"m\",]]",
                                "PROJCS[UNIT[\"m\",-1]]", "PROJCS[UNIT[\"m\",nan]]", "]]]]"}) {
    EXPECT_FALSE(scan_with(bad).unit_m.has_value()) << bad;
  }
}

TEST_F(LasTest, ChecksDeclaredCounts) {
  const std::string narrow = las_file(las_points(2, 3));
  expect_parts(refusal_of(patched(narrow, 107, 4U), "a.las"), "a.las", "4 points", "only 3");
  expect_parts(refusal_of(patched(narrow, 107, 0xffffffffU)), "4294967295 points", "only 3");
  expect_parts(refusal_of(patched(narrow, 107, 0U)), "no point");
  const std::string wide = las_file(las_points(4, 6));
  EXPECT_EQ(read(wide).positions.size(), 3U);
  expect_parts(refusal_of(patched(wide, 247, ~std::uint64_t{0})), "18446744073709551615 points",
               "only 3");
  expect_parts(refusal_of(patched(wide, 247, std::uint64_t{0})), "no point");
  // Records of its own: a count that exceeds the file is no reason to allocate.
  EXPECT_EQ(read(patched(wide, 100, 0xffffffffU)).positions.size(), 3U);
}

TEST_F(LasTest, RefusesInconsistentHeader) {
  const std::string file = las_file(las_points(2, 3));
  expect_parts(refusal_of(patched(file, 24, '\2')), "header", "version 2.2");
  expect_parts(refusal_of(patched(file, 25, '\5')), "header", "version 1.5");
  expect_parts(refusal_of(patched(file, 94, std::uint16_t{100})), "header of 100 bytes");
  expect_parts(refusal_of(patched(file, 96, 0xffffffffU)), "points from byte 4294967295");
  expect_parts(refusal_of(patched(file, 96, 1U)), "points from byte 1");
  expect_parts(refusal_of(patched(file, 104, '\x0b')), "point format 11");
  expect_parts(refusal_of(patched(file, 105, std::uint16_t{0})), "records of 0 bytes");
  expect_parts(refusal_of(patched(file, 105, std::uint16_t{33})), "records of 33 bytes");
  expect_parts(refusal_of(patched(file, 131, 0.0)), "scale");
  expect_parts(refusal_of(patched(file, 163, std::numeric_limits<double>::infinity())), "scale");
  for (std::size_t length = 4; length < file.size(); ++length) {
    expect_parts(refusal_of(std::string_view(file).substr(0, length), "cut.las"), "cut.las",
                 "copy");
  }
}

/// By the bits of its point format, whatever its name.
TEST_F(LasTest, RefusesLazWithRemedy) {
  const std::string plain = las_file(las_points(2, 0));
  EXPECT_EQ(read(plain, "a.laz").positions.size(), 3U);
  for (const int bit : {0x80, 0x40}) {
    std::string file = plain;
    file[104] = static_cast<char>(file[104] | bit);
    expect_parts(refusal_of(file, "a.las"), "a.las", "LAZ", "laszip -i FILE -o scan.las",
                 "pdal translate FILE scan.las");
  }
}

TEST_F(LasTest, ReportsExtraPoints) {
  const std::string file = patched(las_file(las_points(2, 3)), 107, 2U);
  const Scan scan = read(file);
  EXPECT_EQ(scan.positions.size(), 2U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "declares 2 points", "holds 3");
  EXPECT_TRUE(read(las_file(las_points(2, 3)) + std::string(100, '\0')).warnings.empty());
  // From 1.3 on, the bytes after the points may be records of their own.
  EXPECT_TRUE(read(las_file(las_points(4, 6)) + std::string(100, 'r')).warnings.empty());
}

}  // namespace
}  // namespace tactree::builder
