#include "page_recording.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::test {
namespace {

using viewer::PageRecording;

class PageRecordingTest : public FolderTest {
 protected:
  /// Messages of a board at 1 kHz.
  static std::vector<core::wire::Telemetry> messages(std::uint32_t first, std::uint32_t count) {
    std::vector<core::wire::Telemetry> list(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      list[i].header = {first + i, 1000U * (first + i), telemetry::kRecordedFields, 0};
    }
    return list;
  }
  [[nodiscard]] std::string text() const { return recording_.to_json()["text"]; }
  /// The problem of the recording that is being completed.
  std::string problem() {
    while (recording_.to_json()["state"] == "completing") {
      if (const std::optional<std::string> problem = recording_.update()) {
        return *problem;
      }
      std::this_thread::yield();
    }
    return "";
  }
  [[nodiscard]] std::size_t lines(const std::string& name) const {
    std::ifstream in(folder_ / name);
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) {
      ++count;
    }
    return count;
  }

  std::vector<std::string> told_;
  PageRecording recording_{
      {folder_ / "ticks.csv", [this](const std::string& text) { told_.push_back(text); }}};
};

TEST_F(PageRecordingTest, CompletesFileAndStatesIt) {
  EXPECT_EQ(recording_.to_json()["state"], "off");
  recording_.begin({});
  recording_.add(messages(1, 10));
  recording_.add(messages(13, 1));
  EXPECT_EQ(recording_.to_json()["state"], "on");
  const std::string counts =
      (folder_ / "ticks.csv").string() + ": 11 ticks in 0.012 s, 2 missing in 1 gaps";
  EXPECT_EQ(text(), counts);
  recording_.end();
  EXPECT_EQ(problem(), "");
  EXPECT_EQ(recording_.to_json()["state"], "off");
  EXPECT_EQ(text(), counts);
  EXPECT_EQ(lines("ticks.csv"), 12U);
  EXPECT_EQ(told_,
            (std::vector<std::string>{"recording to " + (folder_ / "ticks.csv").string(), counts}));
}

TEST_F(PageRecordingTest, ReplacesNoFile) {
  write("ticks-2.csv.incomplete", "of a program that was killed");
  for (int i = 0; i < 3; ++i) {
    recording_.begin({});
    recording_.add(messages(1, 1));
    recording_.finish();
  }
  for (const char* name : {"ticks.csv", "ticks-3.csv", "ticks-4.csv"}) {
    EXPECT_EQ(lines(name), 2U) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ticks-2.csv"));
}

TEST_F(PageRecordingTest, StatesDecimation) {
  recording_.begin({.every_ticks = 4});
  recording_.add(messages(4, 1));
  EXPECT_NE(text().find("1 ticks in 0.000 s, none missing (one tick of 4)"), std::string::npos)
      << text();
}

TEST_F(PageRecordingTest, StatesWhyItEndedEarly) {
  recording_.begin({});
  recording_.add(messages(1, 5));
  recording_.end("The board is disconnected.");
  recording_.add(messages(6, 5));  // of no recording
  EXPECT_NE(problem().find("ticks.csv: 5 ticks in 0.004 s, none missing; the recording ended "
                           "early. The board is disconnected."),
            std::string::npos);
  EXPECT_EQ(lines("ticks.csv"), 6U);
}

TEST_F(PageRecordingTest, RefusesSecondRecordingAndForeignFolder) {
  recording_.begin({});
  EXPECT_NE(message_of<support::UserError>([&] { recording_.begin({}); }).find("not complete"),
            std::string::npos);
  PageRecording nowhere({folder_ / "none" / "ticks.csv", {}});
  EXPECT_NE(message_of<support::UserError>([&] { nowhere.begin({}); }).find("No such file"),
            std::string::npos);
  EXPECT_EQ(nowhere.to_json()["state"], "off");
}

/// Limits the size of files, like a full disk.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallFiles() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST_F(PageRecordingTest, KeepsRowsOfFullDisk) {
  recording_.begin({});
  recording_.add(messages(1, 5));
  {
    const SmallFiles small(10000);
    recording_.add(messages(6, 1000));
  }
  EXPECT_NE(problem().find("5 ticks in 0.004 s, none missing; the recording ended early. "),
            std::string::npos);
  EXPECT_NE(text().find("cannot be written: File too large"), std::string::npos) << text();
  EXPECT_EQ(lines("ticks.csv"), 6U);
}

}  // namespace
}  // namespace tactree::test
