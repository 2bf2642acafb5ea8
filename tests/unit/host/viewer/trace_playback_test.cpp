// Traces are read back as written; invalid files are refused with the line.

#include "tactree/viewer/trace_playback.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/simulation/trace.hpp"

namespace tactree::test {
namespace {

using simulation::Sample;

class TracePlaybackTest : public FolderTest {
 protected:
  std::vector<Sample> read(const std::string& text) const {
    return viewer::read_trace(write("trace.csv", text));
  }
  std::string refusal(const std::string& text) const {
    return message_of<std::runtime_error>([&] { (void)read(text); });
  }
};

std::vector<Sample> some_samples() {
  std::vector<Sample> samples(5);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& sample = samples[i];
    const float x = 0.1F * static_cast<float>(i + 1) / 3.0F;
    sample.t_s = 0.001 * static_cast<double>(i);
    sample.tip_m = Eigen::Vector3d(0.01, -0.02, 0.03) * static_cast<double>(i);
    core::Status& s = sample.status;
    s.state = i < 3 ? core::State::kActive : core::State::kFault;
    s.probe = {x, -x, x * x};
    s.velocity = {x, 0.0F, -x};
    s.force = {-x, 1.0F / (1.0F + x), 0.0F};
    s.limits = core::limit_bit(core::Limit::kSlew);
    s.faults = i < 3 ? 0U : core::fault_bit(core::Fault::kSupply);
    s.rendering.in_contact = i % 2 == 0;
    s.rendering.slipping = i == 2;
    s.rendering.proxy = {x, x, x};
    s.rendering.normal = {0.0F, 0.6F, 0.8F};
    s.rendering.penetration_m = 0.001F * x;
    s.rendering.strength = 0.75F;
    s.rendering.body = 0;
  }
  return samples;
}

std::string csv_of(const std::vector<Sample>& samples) {
  std::string csv = simulation::trace_heading();
  for (const Sample& sample : samples) {
    simulation::append_trace(csv, sample);
  }
  return csv;
}

TEST_F(TracePlaybackTest, ReadsBackWrittenTrace) {
  const std::string csv = csv_of(some_samples());
  EXPECT_EQ(csv_of(read(csv)), csv);
}

TEST_F(TracePlaybackTest, NeedsTimeProbeAndForce) {
  const auto samples =
      read("t_s,probe_x_m,probe_y_m,probe_z_m,force_x_N,force_y_N,force_z_N\r\n0,1,2,3,4,5,6\r\n");
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].status.probe, (core::Vec3{1.0F, 2.0F, 3.0F}));
  EXPECT_EQ(samples[0].tip_m, Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST_F(TracePlaybackTest, RefusesInvalidFilesWithLine) {
  const std::string heading = simulation::trace_heading();
  const std::string csv = csv_of(some_samples());
  EXPECT_NE(refusal("").find("the trace has no ticks"), std::string::npos);
  EXPECT_NE(refusal(heading).find("the trace has no ticks"), std::string::npos);
  EXPECT_NE(refusal("x,y\n1,2\n").find("line 1: the header has no column t_s"), std::string::npos);
  EXPECT_NE(refusal(csv + "1,2,3\n").find("line 7: 3 values"), std::string::npos);
  const std::string twice = csv + csv.substr(heading.size());
  EXPECT_NE(refusal(twice).find("line 7: t_s does not increase"), std::string::npos);
  std::string word = csv;
  word.replace(word.find("\n0,") + 1, 1, "zero");
  EXPECT_NE(refusal(word).find("line 2: column 1 (t_s) is not a number: 'zero'"),
            std::string::npos);
}

TEST_F(TracePlaybackTest, CommandsStayWithinTrace) {
  viewer::TracePlayback recording(some_samples(), {}, core::presets::premium().model, {});
  using nlohmann::json;
  EXPECT_FALSE(recording.command({{"do", "seek"}, {"tick", 99999}}));
  EXPECT_FALSE(recording.command({{"do", "step"}, {"ticks", -1}}));
  EXPECT_FALSE(recording.command({{"do", "step"}, {"ticks", INT64_MIN}}));
  EXPECT_FALSE(recording.command({{"do", "play"}, {"speed", 0.1}}));
  EXPECT_FALSE(recording.command({{"do", "stop"}}));
  EXPECT_TRUE(recording.command({{"do", "play"}, {"speed", -1}}));
  EXPECT_TRUE(recording.command({{"do", "play"}}));
  EXPECT_TRUE(recording.command({{"do", "seek"}, {"tick", "x"}}));
  EXPECT_TRUE(recording.command({{"do", "hand"}}));
  EXPECT_EQ(recording.trace_csv(), csv_of(some_samples()));
}

}  // namespace
}  // namespace tactree::test
