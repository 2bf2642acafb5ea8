#include <lzf.h>

#include <bit>
#include <limits>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class PcdTest : public TestFiles {};

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   std::size_t width, std::size_t height, const std::string& data) {
  std::string count;
  for (const char c : type) {
    if (c != ' ') count += " 1";
  }
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
         size + "\nTYPE " + type + "\nCOUNT" + count + "\nWIDTH " + std::to_string(width) +
         "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT 1 2 3 0 1 0 0\nPOINTS " +
         std::to_string(width * height) + "\nDATA " + data + "\n";
}

std::string xyz_header(std::size_t points, const std::string& data) {
  return header("x y z", "4 4 4", "F F F", points, 1, data);
}

/// The data after "DATA binary_compressed": the sizes and the LZF stream.
std::string lzf_compressed(const std::string& bytes) {
  std::string packed(bytes.size() * 2 + 64, '\0');
  const unsigned size = ::lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()),
                                       packed.data(), static_cast<unsigned>(packed.size()));
  packed.resize(size);
  return bytes_of(static_cast<std::uint32_t>(size)) +
         bytes_of(static_cast<std::uint32_t>(bytes.size())) + packed;
}

TEST_F(PcdTest, ReadsAsciiNormalsAndColour) {
  const Scan scan = read(header("x y z normal_x normal_y normal_z rgb", "4 4 4 4 4 4 4",
                                "F F F F F F U", 2, 2, "ascii") +
                         "1 2 3 0 0 1 66051\nnan nan nan 0 0 1 0\n4 5 6 nan nan nan 255\n"
                         "7 8 9 1 0 0 16711680\n");
  EXPECT_EQ(scan.format, "PCD ascii");
  ASSERT_EQ(scan.positions.size(), 3U);
  EXPECT_EQ(dropped(scan, "non_finite"), 1U);
  EXPECT_EQ(scan.positions[2], Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(scan.normals.at(1), Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(scan.normals.at(2), Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(scan.colours.at(0), (Colour{1, 2, 3}));
  EXPECT_EQ(scan.colours.at(1), (Colour{0, 0, 255}));
}

/// Four by four points of a wavy wall, row by row, as a camera at `camera` that looks along z sees
/// them: right is x, down is -y.
std::string image(const Eigen::Vector3d& camera, const std::string& viewpoint) {
  std::string text = header("x y z", "4 4 4", "F F F", 4, 4, "ascii");
  text.replace(text.find("1 2 3 0 1 0 0"), 13, viewpoint);
  for (int k = 0; k < 16; ++k) {
    const double depth = 2.0 + 0.4 * std::sin(1.0 * k);
    const Eigen::Vector3d at =
        camera + depth * Eigen::Vector3d(0.1 * (k % 4 - 2), -0.1 * (k / 4 - 2), -1.0);
    text +=
        std::to_string(at.x()) + " " + std::to_string(at.y()) + " " + std::to_string(at.z()) + "\n";
  }
  return text;
}

TEST_F(PcdTest, TakesViewpointAsScannerPose) {
  const Scan stated = read(xyz_header(1, "ascii") + "7 8 9\n");
  ASSERT_EQ(stated.poses.size(), 1U);
  EXPECT_EQ(stated.poses[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(stated.poses[0].sure);
  std::string text = xyz_header(1, "ascii") + "7 8 9\n";
  text.replace(text.find("1 2 3 0 1 0 0"), 13, "0 0 0 1 0 0 0");
  EXPECT_FALSE(read(text).poses.at(0).sure);
  text.replace(text.find("0 0 0 1 0 0 0"), 13, "0 0 nan 1 0 0");
  const Scan bad = read(text);
  EXPECT_TRUE(bad.poses.empty());
  EXPECT_EQ(bad.warnings.size(), 1U);
}

TEST_F(PcdTest, ImageOrderConfirmsPose) {
  const Eigen::Vector3d camera(1, 2, 3);
  const Eigen::Vector3d origin(0, 0, 0);
  EXPECT_EQ(read(image(camera, "1 2 3 1 0 0 0")).poses.at(0).position, camera);
  // Points in the frame of the camera, the pose in another one.
  const Scan moved = read(image(origin, "1 2 -9 1 0 0 0"));
  ASSERT_EQ(moved.poses.size(), 1U);
  EXPECT_EQ(moved.poses[0].position, origin);
  EXPECT_TRUE(moved.poses[0].sure);
  // The default beside points in another frame: the camera was on the other side.
  const Scan unknown = read(image(Eigen::Vector3d(0, 0, 5), "0 0 0 1 0 0 0"));
  EXPECT_TRUE(unknown.poses.empty());
  ASSERT_EQ(unknown.warnings.size(), 1U);
  expect_parts(unknown.warnings[0], "--viewpoint");
}

TEST_F(PcdTest, ReadsColourFromFloatBits) {
  const float packed = std::bit_cast<float>(0x0000'ff40U);
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(packed));
  const Scan bits = read(header("x y z rgb", "4 4 4 4", "F F F F", 1, 1, "ascii") + "1 2 3 " +
                         text.data() + "\n");
  EXPECT_EQ(bits.colours.at(0), (Colour{0, 255, 64}));
  const Scan whole =
      read(header("x y z rgb", "4 4 4 4", "F F F F", 1, 1, "ascii") + "1 2 3 4.2108e+06\n");
  EXPECT_EQ(whole.colours.at(0), (Colour{0x40, 0x40, 0x70}));  // 4210800
}

TEST_F(PcdTest, WarnsOfColoursThatAreLostInText) {
  const std::string head =
      "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n";
  const Scan lost = read(head + "0 0 0 nan\n1 0 0 nan\n");
  EXPECT_TRUE(lost.colours.empty());
  ASSERT_EQ(lost.warnings.size(), 1U);
  expect_parts(lost.warnings[0], "none of them is a number", "PCD in binary form");
  const Scan partly = read(head + "0 0 0 4210800\n1 0 0 nan\n");
  EXPECT_EQ(partly.colours.at(0), (Colour{0x40, 0x40, 0x70}));
  ASSERT_EQ(partly.warnings.size(), 1U);
  expect_parts(partly.warnings[0], "1 of 2 points");
}

TEST_F(PcdTest, ReadsMixedBinaryTypes) {
  const std::string head =
      "VERSION .7\nFIELDS id z y x _ rgba\nSIZE 2 8 4 4 1 4\nTYPE U F I F U U\n"
      "COUNT 1 1 1 1 3 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n";
  const auto point = [](float x, int y, double z, std::uint32_t rgba) {
    return bytes_of(std::uint16_t{7}) + bytes_of(z) + bytes_of(y) + bytes_of(x) + "pad" +
           bytes_of(rgba);
  };
  const Scan scan = read(head + point(1.5F, -2, 1e-9, 0xff0a0b0c) + point(3, 4, 5, 0x00ffffff));
  EXPECT_EQ(scan.format, "PCD binary");
  ASSERT_EQ(scan.positions.size(), 2U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1.5, -2, 1e-9));
  EXPECT_EQ(scan.colours.at(0), (Colour{10, 11, 12}));
  EXPECT_EQ(scan.colours.at(1), (Colour{255, 255, 255}));
}

TEST_F(PcdTest, ReadsCompressedFieldByField) {
  const std::size_t count = 500;
  std::string xs, ys, zs, colours;
  for (std::size_t i = 0; i < count; ++i) {
    xs += bytes_of(i == 3 ? kNan : static_cast<float>(i));
    ys += bytes_of(1.0F);
    zs += bytes_of(static_cast<float>(i % 7));
    colours += bytes_of(static_cast<std::uint32_t>(i));
  }
  const Scan scan = read(header("x y z rgb", "4 4 4 4", "F F F U", 50, 10, "binary_compressed") +
                         lzf_compressed(xs + ys + zs + colours));
  EXPECT_EQ(scan.format, "PCD binary compressed");
  ASSERT_EQ(scan.positions.size(), count - 1);
  EXPECT_EQ(dropped(scan, "non_finite"), 1U);
  EXPECT_EQ(scan.positions.back(), Eigen::Vector3d(499, 1, 2));
  EXPECT_EQ(scan.colours.back(), (Colour{0, 1, 243}));
}

TEST_F(PcdTest, RefusesTruncationAtEveryByte) {
  std::string floats;
  for (int i = 0; i < 30; ++i) floats += bytes_of(static_cast<float>(i % 4));
  const std::string files[] = {xyz_header(10, "binary") + floats,
                               xyz_header(10, "binary_compressed") + lzf_compressed(floats)};
  for (const std::string& whole : files) {
    EXPECT_EQ(read(whole).positions.size(), 10U);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      expect_parts(refusal_of(std::string_view(whole).substr(0, length), "cut.pcd"), "cut.pcd");
    }
  }
}

TEST_F(PcdTest, ReadsColumnsOfOldFiles) {
  const Scan scan = read(
      "VERSION .5\nCOLUMNS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\n"
      "POINTS 1\nDATA ascii\n1 2 3 50\n");
  ASSERT_EQ(scan.positions.size(), 1U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST_F(PcdTest, ChecksDeclaredCounts) {
  const std::string point = bytes_of(1.0F) + bytes_of(2.0F) + bytes_of(3.0F);
  const auto with_points = [](const std::string& points, const std::string& data) {
    return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + points + "\nDATA " + data +
           "\n";
  };
  expect_parts(refusal_of(with_points("4294967295", "binary") + point), "4294967295 points",
               "only 1");
  expect_parts(refusal_of(with_points("4294967295", "ascii") + "1 2 3\n"), "only 1");
  expect_parts(refusal_of(with_points("-1", "binary") + point), "not a count");
  expect_parts(refusal_of(with_points("0", "binary") + point), "contains no points");
  // A number of points whose size in bytes wraps around in 64 bits to the true size.
  expect_parts(
      refusal_of(with_points("4611686018427387905", "binary_compressed") + lzf_compressed(point)),
      "when unpacked");
  expect_parts(refusal_of("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
                          "WIDTH 9223372036854775807\nHEIGHT 9223372036854775807\nDATA ascii\n"),
               "too large");
}

TEST_F(PcdTest, ChecksCompressedSizes) {
  const std::string head = xyz_header(1'000'000, "binary_compressed");
  const std::uint32_t full = 12'000'000;
  expect_parts(
      refusal_of(head + bytes_of(std::uint32_t{20}) + bytes_of(full) + std::string(20, '\x01')),
      "cannot be the compressed form");
  expect_parts(refusal_of(head + bytes_of(std::uint32_t{0}) + bytes_of(full)), "cannot be");
  expect_parts(refusal_of(head + bytes_of(std::uint32_t{400'000}) + bytes_of(full) + "abc"),
               "400000 bytes", "only 3");
  expect_parts(refusal_of(xyz_header(1, "binary_compressed") + bytes_of(std::uint32_t{5}) +
                          bytes_of(std::uint32_t{12}) + "\xff\xff\xff\xff\xff"),
               "compressed data is damaged");
}

TEST_F(PcdTest, RefusesDamagedHeaders) {
  expect_parts(
      refusal_of("VERSION .7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n"),
      "x, y and z");
  expect_parts(refusal_of("VERSION .7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n"),
               "must agree");
  expect_parts(
      refusal_of("VERSION .7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n"),
      "size 3");
  expect_parts(refusal_of("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n"),
               "POINTS");
  expect_parts(refusal_of(xyz_header(1, "zipped")), "\"zipped\"");
  expect_parts(refusal_of("# .PCD v0.7\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\n"), "DATA");
}

TEST_F(PcdTest, RefusesTwoFieldsOfOneName) {
  const auto refusal_with = [&](const std::string& extra) {
    return refusal_of("FIELDS x " + extra +
                          " y z\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
                          "DATA ascii\n1 2 3 4\n",
                      "a.pcd");
  };
  expect_parts(refusal_with("X"), "a.pcd: header", "\"x\" and \"X\"", "export");
  expect_parts(refusal_with("x"), "a.pcd: header", "\"x\" and \"x\"", "export");
}

TEST_F(PcdTest, AsciiRowsMustFit) {
  expect_parts(refusal_of(xyz_header(2, "ascii") + "1 2 3\n1 2\n"), "line 13", "fewer");
  expect_parts(refusal_of(xyz_header(2, "ascii") + "1 2 3\n1 2 x\n"), "line 13", "\"x\"");
  expect_parts(refusal_of(xyz_header(2, "ascii") + "1 2 3\n1 2 3 4\n"), "line 13", "more");
}

}  // namespace
}  // namespace tactree::builder
