// Traces are read back as written; invalid files are refused with the line.

#include "tactree/viewer/trace_playback.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/core/link/wire/telemetry.hpp"
#include "tactree/simulation/trace.hpp"
#include "tactree/telemetry/tick_file.hpp"

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

/// The ticks of a board with the states of the samples.
std::vector<telemetry::Tick> ticks_of(const std::vector<Sample>& samples) {
  std::vector<telemetry::Tick> ticks;
  for (const Sample& sample : samples) {
    telemetry::Tick tick;
    tick.time_us = 1000 * ticks.size();
    core::Status status = sample.status;
    status.motor_force = {1.0F, 0.1F, -2.0F};
    tick.telemetry = core::wire::to_telemetry({0, 0, telemetry::kRecordedFields, 0}, status);
    ticks.push_back(tick);
  }
  return ticks;
}

TEST_F(TracePlaybackTest, ShowsRecordingsOfBoard) {
  const std::vector<telemetry::Tick> ticks = ticks_of(some_samples());
  std::vector<std::string> shown;
  for (const char* name : {"board.csv", "board.npz"}) {
    const auto file = telemetry::open_tick_file(folder_ / name);
    file->append(ticks);
    file->finish();
    const std::vector<Sample> samples = viewer::read_trace(folder_ / name);
    EXPECT_TRUE(samples[0].has_parts);
    EXPECT_EQ(samples[0].status.motor_force, (core::Vec3{1.0F, 0.1F, -2.0F}));
    EXPECT_EQ(samples[4].status.state, core::State::kFault);
    shown.push_back(csv_of(samples));
  }
  EXPECT_EQ(shown[0], shown[1]);
  EXPECT_EQ(std::count(shown[0].begin(), shown[0].end(), '\n'), 6);
}

TEST_F(TracePlaybackTest, RefusesArchivesOfOtherPrograms) {
  EXPECT_NE(message_of<std::runtime_error>([&] {
              (void)viewer::read_trace(write("other.npz", "t_s,probe_x_m\n"));
            }).find("other.npz: not an archive of NumPy"),
            std::string::npos);
}

TEST_F(TracePlaybackTest, ShowsCutRecordingUpToLastRow) {
  const std::vector<telemetry::Tick> ticks = ticks_of(some_samples());
  telemetry::open_tick_file(folder_ / "cut.csv")->append(ticks);
  const auto file = folder_ / "cut.csv.incomplete";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
  EXPECT_EQ(viewer::read_trace(file).size(), ticks.size() - 1);
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
