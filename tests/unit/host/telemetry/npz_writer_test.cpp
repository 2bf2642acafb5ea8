#include "npz_writer.hpp"

#include <gtest/gtest.h>
#include <unzip.h>

#include <cstring>
#include <string>
#include <vector>

#include "folder_test.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

namespace fs = std::filesystem;

class NpzTest : public test::FolderTest {
 protected:
  static std::vector<double> row_of(int i) {
    return {i + 0.25, static_cast<double>(-0.1F), 4e9 + i, -1.0, i % 2 == 0 ? 0.0 : 1.0};
  }
  void write(int rows) const {
    NpzWriter writer(file_, {{"t_s", ColumnType::kFloat64, {}},
                             {"force", ColumnType::kFloat32, {}},
                             {"tick", ColumnType::kUint32, {}},
                             {"body", ColumnType::kInt32, {}},
                             {"state", ColumnType::kUint8, {"idle", "active"}}});
    for (int i = 0; i < rows; ++i) {
      writer.append(row_of(i));
    }
    writer.finish();
  }
  /// The bytes of an entry, whose checksum is correct.
  [[nodiscard]] std::string entry(const char* name) const {
    unzFile archive = unzOpen64(file_.c_str());
    EXPECT_EQ(unzLocateFile(archive, name, 1), UNZ_OK) << name;
    unz_file_info64 info{};
    EXPECT_EQ(unzGetCurrentFileInfo64(archive, &info, nullptr, 0, nullptr, 0, nullptr, 0), UNZ_OK);
    std::string bytes(info.uncompressed_size, '\0');
    EXPECT_EQ(unzOpenCurrentFile(archive), UNZ_OK);
    EXPECT_EQ(unzReadCurrentFile(archive, bytes.data(), static_cast<unsigned>(bytes.size())),
              static_cast<int>(bytes.size()));
    EXPECT_EQ(unzCloseCurrentFile(archive), UNZ_OK);
    unzClose(archive);
    return bytes;
  }
  template <class T>
  [[nodiscard]] std::vector<double> values(const char* name, const std::string& descr) const {
    const std::string bytes = entry(name);
    const std::size_t begin = bytes.find('\n') + 1;
    EXPECT_EQ(begin % 64, 0U);
    EXPECT_NE(bytes.find("'descr': '" + descr + "'"), std::string::npos);
    std::vector<double> all;
    for (std::size_t at = begin; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
      T value;
      std::memcpy(&value, bytes.data() + at, sizeof value);
      all.push_back(static_cast<double>(value));
    }
    EXPECT_NE(bytes.find("'shape': (" + std::to_string(all.size()) + ",)"), std::string::npos);
    return all;
  }

  fs::path file_ = folder_ / "rows.npz";
};

// More rows than two blocks of the writer.
TEST_F(NpzTest, KeepsEveryRow) {
  constexpr int kRows = 40000;
  write(kRows);
  const std::vector<std::vector<double>> columns = {
      values<double>("t_s.npy", "<f8"), values<float>("force.npy", "<f4"),
      values<std::uint32_t>("tick.npy", "<u4"), values<std::int32_t>("body.npy", "<i4"),
      values<std::uint8_t>("state.npy", "|u1")};
  for (std::size_t column = 0; column < columns.size(); ++column) {
    ASSERT_EQ(columns[column].size(), kRows);
    for (int i = 0; i < kRows; ++i) {
      ASSERT_EQ(columns[column][static_cast<std::size_t>(i)], row_of(i)[column]) << i;
    }
  }
}

TEST_F(NpzTest, WritesWordsAsUcs4) {
  write(0);
  EXPECT_TRUE(values<double>("t_s.npy", "<f8").empty());
  const std::string names = entry("state_names.npy");
  EXPECT_NE(names.find("'descr': '<U6'"), std::string::npos);
  EXPECT_EQ(names.substr(names.find('\n') + 1 + 24, 8), std::string("a\0\0\0c\0\0\0", 8));
}

TEST_F(NpzTest, LeavesNothingWithoutFinish) {
  {
    NpzWriter writer(file_, {{"t_s", ColumnType::kFloat64, {}}});
    for (int i = 0; i < 20000; ++i) {
      writer.append(std::vector<double>{1.0});
    }
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace tactree::telemetry
