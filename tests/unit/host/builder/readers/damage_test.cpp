// The seeds of the fuzz target with random damage: a reader returns a consistent scan or throws
// ReadError for any bytes.

#include <fstream>
#include <iterator>
#include <random>

#include "folders.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

class DamageTest : public TestFiles, public testing::WithParamInterface<const char*> {
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

TEST_P(DamageTest, ReadsOrRefuses) {
  std::ifstream in(test::seeds_folder() / "read_scan" / GetParam(), std::ios::binary);
  damage({std::istreambuf_iterator<char>(in), {}}, 3000);
}
INSTANTIATE_TEST_SUITE_P(Seeds, DamageTest,
                         testing::Values("csv", "csv_normals", "csv_semicolon", "e57_cartesian",
                                         "e57_two_scans", "las_1_2", "las_1_4", "obj", "off",
                                         "off_binary", "pcd_ascii", "pcd_binary", "pcd_compressed",
                                         "ply_ascii", "ply_big_endian", "ply_lists",
                                         "ply_little_endian", "pts", "ptx", "stl_ascii",
                                         "stl_binary", "xyz"),
                         [](const auto& seed) { return std::string(seed.param); });

}  // namespace
}  // namespace tactree::builder
