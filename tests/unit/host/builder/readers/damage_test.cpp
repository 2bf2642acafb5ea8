// Files with random damage: a reader returns a consistent scan or throws ReadError for any bytes.

#include <cmath>
#include <random>
#include <vector>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

class DamageTest : public TestFiles {
 protected:
  /// True if the file was read.
  bool read_damaged(std::string_view bytes) {
    const auto path = write("damaged", bytes);
    ReadOptions options;
    options.scan_memory_bytes = 1 << 24;
    options.child_seconds = 5;
    try {
      expect_sound(read_scan(path, options));
      return true;
    } catch (const ReadError& error) {
      EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos);
      return false;
    }
  }

  static void expect_sound(const Scan& scan) {
    EXPECT_FALSE(scan.positions.empty());
    for (const auto& position : scan.positions) EXPECT_TRUE(position.allFinite());
    EXPECT_TRUE(scan.normals.empty() || scan.normals.size() == scan.positions.size());
    for (const auto& normal : scan.normals) EXPECT_TRUE(normal.allFinite());
    EXPECT_TRUE(scan.colours.empty() || scan.colours.size() == scan.positions.size());
    for (const auto& triangle : scan.triangles) {
      for (const std::uint32_t corner : triangle) EXPECT_LT(corner, scan.positions.size());
    }
  }

  /// Damages `seed` at random and truncates it at every byte.
  void damage(const std::string& seed, unsigned rounds) {
    ASSERT_TRUE(read_damaged(seed));
    std::mt19937 random(1234);
    const auto below = [&](std::size_t end) { return random() % end; };
    std::size_t refused = 0;
    for (unsigned round = 0; round < rounds; ++round) {
      std::string bytes = seed;
      for (std::size_t change = 0; change <= below(4); ++change) {
        const std::size_t at = below(bytes.size());
        switch (below(5)) {
          case 0:
            bytes[at] = static_cast<char>(random());
            break;
          case 1:
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
            break;
          case 2:
            bytes.erase(at, 1 + below(8));
            break;
          case 3:
            bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(40)));
            break;
          default:
            bytes.insert(at, std::to_string(random()));
        }
        if (bytes.empty()) bytes = "x";
      }
      if (!read_damaged(bytes)) ++refused;
    }
    EXPECT_GT(refused, 0U);
    for (std::size_t length = 1; length < seed.size(); ++length) {
      (void)read_damaged(std::string_view(seed).substr(0, length));
    }
  }
};

constexpr unsigned kRounds = 3000;

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n"
         "property list uchar int tags\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face 2\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}

TEST_F(DamageTest, ReadsOrRefusesAsciiPly) {
  damage(ply_header("ascii") +
             "0 0 0 0 1 2 3\n1 0 0 1 9 1 2 3\n1 1 0 2 9 9 1 2 3\n0 1 0 0 1 2 3\n4 0 1 2 3\n"
             "3 0 1 2\n",
         kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesBinaryPly) {
  for (const bool big : {false, true}) {
    std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
    for (int i = 0; i < 4; ++i) {
      bytes += bytes_of(static_cast<float>(i), big) + bytes_of(1.0 * i * i, big) +
               bytes_of(std::int16_t{5}, big) + '\x01' + bytes_of(7, big) + "rgb";
    }
    bytes += '\x04';
    for (int i = 0; i < 4; ++i) bytes += bytes_of(i, big);
    bytes += '\x03';
    for (int i = 0; i < 3; ++i) bytes += bytes_of(i, big);
    damage(bytes, kRounds);
  }
}

std::string pcd_header(const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
         "WIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA " +
         data + "\n";
}

TEST_F(DamageTest, ReadsOrRefusesPcd) {
  damage(pcd_header("ascii") + "1 2 3 4\n4 5 6 7\n7 8 9 10\n", kRounds);
  std::string points;
  for (int i = 0; i < 12; ++i) points += bytes_of(static_cast<float>(i));
  damage(pcd_header("binary") + points, kRounds);
  // LZF: a control byte of n - 1, then n literal bytes.
  const std::string packed = '\x1f' + points.substr(0, 32) + '\x0f' + points.substr(32);
  damage(pcd_header("binary_compressed") + bytes_of(static_cast<std::uint32_t>(packed.size())) +
             bytes_of(std::uint32_t{48}) + packed,
         kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesText) {
  std::string rows = "//X,Y,Z,Nx,Ny,Nz\n3\n";
  for (int i = 0; i < 20; ++i) rows += std::to_string(i) + ",2,-3e2,0,0,1\n";
  damage(rows, kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesObj) {
  damage(
      "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nvn 0 0 1\n"
      "f 1//1 2//1 3//1 4//1\nf -1 -2 \\\n-3\n",
      kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesOff) {
  damage("COFF\n4 2 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n4 0 1 2 3\n",
         kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesBinaryOff) {
  std::string bytes = "NOFF BINARY\n";
  for (const int count : {3, 1, 0}) bytes += bytes_of(count, true);
  for (int i = 0; i < 18; ++i) bytes += bytes_of(static_cast<float>(i % 5), true);
  for (const int number : {3, 0, 1, 2, 0}) bytes += bytes_of(number, true);
  damage(bytes, kRounds);
}

TEST_F(DamageTest, ReadsOrRefusesStl) {
  damage(
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid s\n",
      kRounds);
  std::string binary(80, ' ');
  binary += bytes_of(2U);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 12; ++k)
      binary += bytes_of(k == 2 ? 1.0F : static_cast<float>(k * (i + 1)));
    binary += std::string(2, '\0');
  }
  damage(binary, kRounds);
}

}  // namespace
}  // namespace tactree::builder
