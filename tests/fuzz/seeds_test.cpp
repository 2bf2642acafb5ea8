// The seeds are what their names say; else the fuzzer would start from nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tactree/builder/read_scan.hpp"
#include "tactree/core/blob.hpp"

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

TEST(Seeds, BlobsAreAcceptedOrRefusedAsNamed) {
  std::set<std::string> seen;
  for (const auto& entry : fs::directory_iterator(TACTREE_SEEDS "/open_blob")) {
    const std::string file = entry.path().filename().string();
    const std::string status = file.substr(0, file.find('.'));
    EXPECT_EQ(name_of(open(entry.path())), status) << file;
    seen.insert(status);
  }
  // Every rule but the alignment, which no file can break.
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(BlobStatus::kBadMaterials));
}

TEST(Seeds, ScansAreRead) {
  std::set<std::string> formats;
  for (const auto& entry : fs::directory_iterator(TACTREE_SEEDS "/read_scan")) {
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

}  // namespace
