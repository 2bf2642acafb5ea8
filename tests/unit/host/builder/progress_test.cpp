#include "tactree/builder/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace tactree::builder {
namespace {

std::string output_of(ProgressStyle style) {
  std::FILE* file = std::tmpfile();
  {
    const auto progress = make_progress(style, file);
    progress->begin("reading \"a\\b\"");
    for (int i = 0; i <= 1000; ++i) {
      progress->advance(0.001 * i);
    }
    progress->end();
  }
  std::rewind(file);
  std::string text;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    text += static_cast<char>(c);
  }
  std::fclose(file);
  return text;
}

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Progress, PrintsNothingPipedOrOff) {
  EXPECT_EQ(output_of(ProgressStyle::kAuto), "");
  EXPECT_EQ(output_of(ProgressStyle::kOff), "");
}

TEST(Progress, PrintsPlainLinePerStep) {
  const std::string text = output_of(ProgressStyle::kPlain);
  EXPECT_EQ(count_lines(text), 1U);
  EXPECT_NE(text.find("reading \"a\\b\""), std::string::npos);
}

TEST(Progress, PrintsJsonObjectPerLine) {
  const std::string text = output_of(ProgressStyle::kJson);
  EXPECT_GT(count_lines(text), 10U);
  EXPECT_LT(count_lines(text), 30U);
  EXPECT_EQ(text.rfind("{\"step\": \"reading \\\"a\\\\b\\\"\", \"fraction\": 0.00", 0), 0U);
  EXPECT_NE(text.find("\"fraction\": 1.00"), std::string::npos);
}

TEST(Progress, EstimatesTimeLeft) {
  EXPECT_EQ(progress_line("reading", -1.0, 5.0), "reading ...");
  EXPECT_EQ(progress_line("reading", 0.0, 5.0), "reading 0 %");
  EXPECT_EQ(progress_line("reading", 0.5, 0.9), "reading 50 %");
  EXPECT_EQ(progress_line("reading", 0.25, 2.0), "reading 25 %, 6 s left");
  EXPECT_EQ(progress_line("reading", 1.0, 2.0), "reading 100 %");
}

}  // namespace
}  // namespace tactree::builder
