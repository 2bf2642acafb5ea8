// Real scans from external sources, if their folder exists.

#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "folders.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

namespace fs = std::filesystem;

class SharedData : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(root_)) GTEST_SKIP() << "no folder of real scans at " << root_;
  }

  /// The message of the refusal, or "" if the file was read into `scan`.
  std::string read(const std::string& name, Scan& scan) const {
    try {
      scan = read_scan(root_ / name);
      return "";
    } catch (const ReadError& error) {
      return error.what();
    }
  }

  const fs::path root_ = test::scans_folder();
};

struct Listed {
  std::string name;
  std::string format;
  std::uint64_t points = 0;
};

/// The rows of files.tsv with the number of points of a file.
std::vector<Listed> listed_files(const fs::path& root) {
  std::vector<Listed> files;
  std::ifstream in(root / "files.tsv");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
    if (cells.size() < 4 || cells[0].starts_with("malformed/")) continue;
    if (cells[3].empty() || cells[3].find_first_not_of("0123456789") != std::string::npos) continue;
    files.push_back({cells[0], cells[2], std::stoull(cells[3])});
  }
  return files;
}

/// The list counts all corners of an STL; the reader joins equal ones.
std::uint64_t listed_points_of(const Scan& scan) {
  if (scan.format.starts_with("STL")) {
    return 3 * (scan.triangles.size() + dropped(scan, "degenerate_face"));
  }
  return scan.positions.size() + dropped(scan, "non_finite") + dropped(scan, "not_measured");
}

TEST_F(SharedData, MatchesListedPointCounts) {
  std::size_t read_count = 0;
  for (const Listed& file : listed_files(root_)) {
    const bool supported = file.format.starts_with("PLY") || file.format.starts_with("PCD") ||
                           file.format.starts_with("OBJ") || file.format.starts_with("STL") ||
                           file.format.starts_with("E57") || file.format.starts_with("LAS");
    if (!supported || !fs::exists(root_ / file.name)) continue;
    Scan scan;
    const std::string message = read(file.name, scan);
    if (file.points == 0) {
      EXPECT_NE(message.find("no point"), std::string::npos) << file.name << ": " << message;
      continue;
    }
    ASSERT_EQ(message, "");
    EXPECT_EQ(listed_points_of(scan), file.points) << file.name;
    ++read_count;
  }
  EXPECT_GE(read_count, 60U);
}

TEST_F(SharedData, ReadsTextAndOff) {
  const std::map<std::string, std::size_t> expected = {
      {"awkward/Wuson.off", 3205},      {"awkward/comments.off", 8},
      {"awkward/diamond_color.off", 6}, {"awkward/rectangle_vertex_colors_float.off", 4},
      {"parts/fandisk.off", 7229},      {"pdal/gdal_data.xyz", 400},
      {"pdal/pts_bunny_8.pts", 9},      {"pdal/pts_test.pts", 19},
      {"pdal/text_crlf_test.txt", 10},  {"pdal/text_duplicates-unsorted.txt", 7},
      {"pdal/text_numeric_dim.txt", 5}, {"pdal/text_utm17_1.txt", 10},
      {"text/diamond.xyz", 6},          {"text/points_cloudcompare.xyz", 101},
  };
  for (const auto& [name, points] : expected) {
    if (!fs::exists(root_ / name)) continue;
    Scan scan;
    EXPECT_EQ(read(name, scan), "");
    EXPECT_EQ(scan.positions.size(), points) << name;
  }
}

TEST_F(SharedData, ReadsOrRefusesEveryFile) {
  const std::map<std::string, std::string> unsupported = {
      {".laz", "LAZ file"}, {".drc", "Draco"},  {".vtk", "VTK file"},  {".msh", "Gmsh mesh"},
      {".node", "TetGen"},  {".inp", "Abaqus"}, {".asc", "ESRI grid"}, {".json", "JSON"}};
  const std::set<std::string> empty_or_prose = {"README.md",
                                                "files.tsv",
                                                "text_text.txt",
                                                "las_no-points.las",
                                                "PinholeImageWithDistortionParameters.e57",
                                                "test filename \u00e4\u00f6\u00fc.e57",
                                                "ZeroPoints.e57",
                                                "empty.e57",
                                                "empty_pc.e57",
                                                "minimal-e57-1.0-unmodified-valid.e57",
                                                "minimal-ply-1.0_ascii-unmodified-unknown.ply",
                                                "minimal-ply-1.0_binary-unmodified-unknown.ply"};
  for (const auto& entry : fs::recursive_directory_iterator(root_)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), root_).string();
    if (name.starts_with("malformed/")) continue;  // has tests of its own
    Scan scan;
    const std::string message = read(name, scan);
    const auto kind = unsupported.find(entry.path().extension().string());
    if (kind != unsupported.end()) {
      expect_parts(message, name, kind->second);
    } else if (empty_or_prose.contains(entry.path().filename().string())) {
      EXPECT_NE(message, "") << name;
    } else {
      EXPECT_EQ(message, "") << name;
    }
  }
}

TEST_F(SharedData, RefusesMalformedFilesWithCause) {
  const std::map<std::string, std::string> causes = {
      {"assimp_invalid/OutOfMemory.off", "353535235358 points"},
      {"assimp_invalid/crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply", "line 7"},
      {"assimp_invalid/empty.3ds", "empty (0 bytes)"},
      {"assimp_invalid/empty.obj", "empty (0 bytes)"},
      {"assimp_invalid/empty.off", "empty (0 bytes)"},
      {"assimp_invalid/empty.ply", "empty (0 bytes)"},
      {"assimp_invalid/invalid.off", "line 7"},
      {"assimp_invalid/readme.txt", "not a list of points"},
      {"derived/ascii_short_rows.ply", "line 9"},
      {"derived/count_4294967295.ply", "4294967295 vertices"},
      {"derived/count_negative.ply", "negative"},
      {"derived/guanyin_truncated_25pct.ply", "only 59529"},
      {"derived/html_error_page.ply", "HTML"},
      {"derived/no_end_header.ply", "end_header"},
      {"derived/no_z.ply", "no property \"z\""},
      {"derived/obj_index_out_of_range.obj", "line 4"},
      {"derived/png_named.ply", "PNG"},
      {"derived/stl_count_lie.stl", "4294967295 triangles and holds 260"},
      {"derived/stl_truncated.stl", "260 triangles and holds 98"},
      {"derived/unknown_type.ply", "float128"},
      {"las/broken_coder.laz", "LAZ"},
      {"las/broken_compressor.laz", "LAZ"},
      {"las/broken_size.laz", "LAZ"},
      {"las/broken_type.laz", "LAZ"},
      {"las/broken_version.laz", "LAZ"},
      {"trimesh/empty.obj", "no point"},
      {"trimesh/empty.ply", "no point"},
      {"trimesh/empty.stl", "no triangle"},
      {"trimesh/emptyIO_obj_empty.obj", "no point"},
      {"trimesh/emptyIO_ply_empty_ascii.ply", "no point"},
      {"trimesh/emptyIO_ply_empty_bin.ply", "no point"},
      {"trimesh/emptyIO_ply_empty_header.ply", "no element \"vertex\""},
      {"trimesh/emptyIO_stl_empty_ascii.stl", "no triangle"},
      {"trimesh/emptyIO_stl_empty_bin.stl", "no triangle"},
  };
  for (const auto& [name, cause] : causes) {
    const std::string path = "malformed/" + name;
    if (!fs::exists(root_ / path)) continue;
    Scan scan;
    const std::string message = read(path, scan);
    EXPECT_NE(message, "") << path << " was read";
    expect_parts(message, path, cause);
  }
}

TEST_F(SharedData, ReadsUsableMalformedFiles) {
  struct Usable {
    const char* name;
    std::size_t points;
    std::size_t triangles;
    const char* cause;
    std::uint64_t count;
  };
  constexpr Usable kUsable[] = {
      {"malformed/derived/ascii_nan_inf.ply", 1, 0, "non_finite", 3},
      {"malformed/assimp_invalid/malformed.obj", 8, 7, "face_index_out_of_range", 2},
      {"malformed/assimp_invalid/malformed2.obj", 8, 10, "degenerate_face", 1},
      {"malformed/trimesh/notenoughindices.obj", 3, 1, "degenerate_face", 1},
      {"malformed/trimesh/face_in_group_name.obj", 1, 0, "", 0},
      {"malformed/trimesh/obj_with_no_face_in_chunk.obj", 3, 1, "", 0},
  };
  for (const Usable& file : kUsable) {
    if (!fs::exists(root_ / file.name)) continue;
    Scan scan;
    EXPECT_EQ(read(file.name, scan), "");
    EXPECT_EQ(scan.positions.size(), file.points) << file.name;
    EXPECT_EQ(scan.triangles.size(), file.triangles) << file.name;
    EXPECT_EQ(dropped(scan, file.cause), file.count) << file.name;
    EXPECT_EQ(scan.warnings.size(), file.count > 0 ? 1U : 0U) << file.name;
  }
}

TEST_F(SharedData, ReadsOrRefusesMalformedFiles) {
  for (const auto& entry : fs::recursive_directory_iterator(root_ / "malformed")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), root_).string();
    Scan scan;
    const std::string message = read(name, scan);
    if (message.empty()) {
      EXPECT_FALSE(scan.positions.empty()) << name;
    } else {
      expect_parts(message, entry.path().filename().string());
    }
  }
}

}  // namespace
}  // namespace tactree::builder
