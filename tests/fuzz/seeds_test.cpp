// Checks that each seed is accepted, or refused for the rule in its name.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "folders.hpp"
#include "image/firmware_image.hpp"
#include "scan/read_points.hpp"
#include "tactree/builder/read_materials.hpp"
#include "tactree/builder/read_scan.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace {

namespace fs = std::filesystem;
using tactree::core::BlobStatus;

const char* name_of(BlobStatus status) {
  static constexpr const char* kNames[] = {
      "kOk",      "kMisaligned",  "kTooShort",  "kBadMagic",      "kBadVersion",
      "kBadSize", "kBadChecksum", "kBadHeader", "kBadFigures",    "kBadSections",
      "kBadTree", "kBadLeaves",   "kBadPoints", "kBadNeighbours", "kBadMaterials"};
  return kNames[static_cast<std::size_t>(status)];
}

BlobStatus open(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                std::istreambuf_iterator<char>()};
  std::vector<std::uint32_t> words(bytes.size() / 4 + 1);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(words.data()));
  tactree::core::BlobView view;
  return open_blob(std::as_bytes(std::span(words)).first(bytes.size()), view);
}

TEST(Seeds, GivesNamedBlobStatus) {
  std::set<std::string> seen;
  for (const auto& entry : fs::directory_iterator(tactree::test::seeds_folder() / "open_blob")) {
    const std::string file = entry.path().filename().string();
    const std::string status = file.substr(0, file.find('.'));
    EXPECT_EQ(name_of(open(entry.path())), status) << file;
    seen.insert(status);
  }
  // Every rule except alignment, which a file cannot violate.
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(BlobStatus::kBadMaterials));
}

std::vector<fs::path> seeds_of(const char* target) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(tactree::test::seeds_folder() / target)) {
    files.push_back(entry.path());
  }
  return files;
}

TEST(Seeds, ReadsCommandLineFiles) {
  for (const fs::path& file : seeds_of("read_device")) {
    EXPECT_NO_THROW((void)tactree::support::load_device(file.string())) << file;
  }
  for (const fs::path& file : seeds_of("read_firmware")) {
    EXPECT_EQ(tactree::cli::read_firmware(file).board, "board");
  }
  for (const char* name : {"one", "colours"}) {
    const std::string file = tactree::test::seeds_folder() / "read_materials" / name;
    EXPECT_NO_THROW((void)tactree::builder::read_materials(file)) << name;
  }
  const fs::path scenes = tactree::test::seeds_folder() / "read_scene";
  const std::string blob = tactree::test::seeds_folder() / "open_blob/kOk.surface";
  EXPECT_EQ(tactree::setup::read_scene(scenes / "moving", {blob}).bodies.size(), 1U);
  EXPECT_EQ(tactree::cli::read_points(tactree::test::seeds_folder() / "read_rows/points").size(),
            2U);
  for (const fs::path& file : seeds_of("read_trace")) {
    EXPECT_EQ(tactree::viewer::read_trace(file).size(), 2U) << file;
  }
  EXPECT_GE(seeds_of("read_rows").size(), 2U + tactree::simulation::injection_kinds().size());
}

TEST(Seeds, ReadsScans) {
  std::set<std::string> formats;
  for (const auto& entry : fs::directory_iterator(tactree::test::seeds_folder() / "read_scan")) {
    try {
      const auto scan = tactree::builder::read_scan(entry.path());
      EXPECT_GE(scan.positions.size(), 2U) << entry.path();
      formats.insert(scan.format);
    } catch (const tactree::builder::ReadError& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_GE(formats.size(), 10U);
}

/// As the import process reads them, with colours where the format has them.
TEST(Seeds, ReadsMeshes) {
  std::set<std::string> formats;
  for (const fs::path& file : seeds_of("import_mesh")) {
    if (file.filename() == "3mf_document" || file.filename() == "collada") {
      continue;  // no files by themselves
    }
    try {
      const auto scan = tactree::builder::read_scan(file);
      EXPECT_EQ(scan.triangles.size(), 1U) << file;
      formats.insert(scan.format);
    } catch (const tactree::builder::ReadError& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_EQ(formats.size(), 4U);
}

}  // namespace
