#include "tactree/simulation/trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tactree/core/math/crc32.hpp"

namespace tactree::test {
namespace {

using simulation::Sample;

std::vector<Sample> samples(int count) {
  std::vector<Sample> all(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Sample& s = all[static_cast<std::size_t>(i)];
    s.t_s = i * 1e-3;
    s.status.state = core::State::kActive;
    s.status.force = {0.1F, 0.0F, i == count / 2 ? 3.0F : 1.0F};
    s.status.rendering.in_contact = true;
    s.status.rendering.penetration_m = 1e-3F;
  }
  return all;
}

TEST(Trace, HasValueForEachColumn) {
  const std::string heading = simulation::trace_heading();
  std::string row;
  simulation::append_trace(row, samples(3)[1]);
  EXPECT_EQ(std::count(row.begin(), row.end(), ','),
            std::count(heading.begin(), heading.end(), ','));
  EXPECT_EQ(row.substr(0, 6), "0.001,");
  EXPECT_NE(row.find(",0.100000001,0,3,1,active,"), std::string::npos) << row;
  EXPECT_EQ(heading.back(), '\n');
  EXPECT_EQ(row.back(), '\n');
}

TEST(Plot, LabelsCurvesAndKeepsSpikes) {
  const std::string svg = simulation::plot_svg(samples(20'000), "a <b> & c");
  for (const char* words : {"force / N", "penetration / mm", "time / s", "force x", "force z",
                            "force size", "a &lt;b&gt; &amp; c", "</svg>"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  EXPECT_LT(svg.size(), 400'000U);
  // The one tick of 3 N is drawn at the top of its panel: the axis ends 5 % above it.
  EXPECT_NE(svg.find(",82.9 "), std::string::npos);
  EXPECT_NO_THROW((void)simulation::plot_svg({}, ""));
}

TEST(Plot, ShowsSingleLongTick) {
  simulation::Histogram histogram{
      "instructions per tick", 128.0, {{1024.0, 9999.0}, {4096.0, 1.0}}, 8000.0};
  const std::string svg = simulation::plot_svg(samples(100), "t", histogram);
  for (const char* words : {"instructions per tick", "proven bound", ">10000<"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  std::vector<double> heights;
  for (std::size_t at = svg.find("class=\"bar\""); at != std::string::npos;
       at = svg.find("class=\"bar\"", at + 1)) {
    heights.push_back(std::stod(svg.substr(svg.find("height=\"", at) + 8)));
  }
  ASSERT_EQ(heights.size(), 2U);
  EXPECT_GT(heights[0], 4.0 * heights[1]);
  EXPECT_GT(heights[1], 20.0);
  EXPECT_EQ(simulation::plot_svg(samples(100), "t").find("class=\"bar\""), std::string::npos);
}

TEST(Recorder, ChecksumCoversForceBytes) {
  simulation::Recorder recorder;
  std::vector<float> forces;
  for (const Sample& s : samples(10)) {
    recorder.add(s);
    forces.insert(forces.end(), {s.status.force.x, s.status.force.y, s.status.force.z});
  }
  const simulation::Summary summary = recorder.summary();
  EXPECT_EQ(summary.trace_crc32, core::crc32(std::as_bytes(std::span(forces))));
  EXPECT_NEAR(summary.force_step_max_N, 2.0, 1e-6);
  EXPECT_NEAR(summary.force_max_N, 3.0017, 1e-3);
  EXPECT_EQ(summary.contact_ticks, 10U);
}

}  // namespace
}  // namespace tactree::test
