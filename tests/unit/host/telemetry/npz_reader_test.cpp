#include "tactree/telemetry/npz_reader.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "npz_writer.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

class NpzReaderTest : public test::FolderTest {
 protected:
  void SetUp() override {
    NpzWriter writer(file_, {{"t_s", ColumnType::kFloat64, {}},
                             {"force", ColumnType::kFloat32, {}},
                             {"tick", ColumnType::kUint32, {}},
                             {"body", ColumnType::kInt32, {}},
                             {"state", ColumnType::kUint8, {"idle", "active"}}});
    for (int i = 0; i < 3; ++i) {
      writer.append(std::vector<double>{i + 0.25, static_cast<double>(-0.1F), 4e9 + i, -1.0, 1.0});
    }
    writer.finish();
  }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The refusal of an archive with these bytes.
  [[nodiscard]] std::string refusal(const std::string& bytes, std::size_t rows_max = 10) const {
    const auto file = write("other.npz", bytes);
    return test::message_of<support::UserError>([&] {
      const NpzReader reader(file, rows_max);
      for (const char* column : {"t_s", "force", "tick", "body", "state"}) {
        (void)reader.values(column);
      }
      (void)reader.words("state");
    });
  }

  std::filesystem::path file_ = folder_ / "rows.npz";
};

TEST_F(NpzReaderTest, ReadsEveryType) {
  const NpzReader reader(file_, 3);
  EXPECT_EQ(reader.values("t_s"), (std::vector<double>{0.25, 1.25, 2.25}));
  EXPECT_EQ(reader.values("force"), std::vector<double>(3, static_cast<double>(-0.1F)));
  EXPECT_EQ(reader.values("tick"), (std::vector<double>{4e9, 4e9 + 1, 4e9 + 2}));
  EXPECT_EQ(reader.values("body"), std::vector<double>(3, -1.0));
  EXPECT_EQ(reader.values("state"), std::vector<double>(3, 1.0));
  EXPECT_EQ(reader.words("state"), (std::vector<std::string>{"idle", "active"}));
  EXPECT_TRUE(reader.has("tick"));
  EXPECT_FALSE(reader.has("Tick"));
}

TEST_F(NpzReaderTest, RefusesDamage) {
  const std::string good = bytes();
  EXPECT_EQ(refusal(good), "");
  EXPECT_NE(refusal("PK").find("other.npz: not an archive of NumPy"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, good.size() / 2)), "");
  std::string damaged = good;
  damaged[good.find("\x93NUMPY") + 128] ^= 1;
  EXPECT_NE(refusal(damaged).find("other.npz: t_s: the archive is damaged"), std::string::npos);
}

// Sizes, types and names included: such an archive is refused, or read, but not beyond its bytes.
TEST_F(NpzReaderTest, SurvivesDamageOfEveryByte) {
  const std::string good = bytes();
  std::size_t refused = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string damaged = good;
    damaged[i] = static_cast<char>(damaged[i] ^ (i % 2 == 0 ? 0x81 : 0x7F));
    refused += refusal(damaged).empty() ? 0U : 1U;
  }
  EXPECT_GT(refused, good.size() / 2);
}

TEST_F(NpzReaderTest, RefusesMissingOrInvalidArrays) {
  const auto message = [&](const auto& act) { return test::message_of<support::UserError>(act); };
  const NpzReader reader(file_, 3);
  EXPECT_NE(message([&] { (void)reader.values("load"); }).find("rows.npz: load: is missing"),
            std::string::npos);
  EXPECT_NE(message([&] { (void)reader.values("state_names"); }).find("words instead of numbers"),
            std::string::npos);
  EXPECT_NE(message([&] { (void)reader.words("t_s"); }).find("t_s_names: is missing"),
            std::string::npos);
  EXPECT_NE(refusal(bytes(), 2), "");
  EXPECT_NE(message([&] { const NpzReader none(folder_ / "none.npz", 3); }).find("No such file"),
            std::string::npos);
}

}  // namespace
}  // namespace tactree::telemetry
