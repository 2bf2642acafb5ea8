#include "tactree/telemetry/recorded_motion.hpp"

#include <gtest/gtest.h>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/core/control/state_machine.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_file.hpp"

namespace tactree::telemetry {
namespace {

using core::State;

class RecordedMotionTest : public test::FolderTest {
 protected:
  /// Records a tick each millisecond, in these states; the probe moves 1 mm in each.
  std::filesystem::path record(const char* name, const std::vector<State>& states) const {
    const auto path = folder_ / name;
    const auto file = open_tick_file(path);
    Tick tick;
    for (const State state : states) {
      tick.time_us += 1000;
      tick.telemetry.state = static_cast<std::uint32_t>(state);
      for (float& coordinate : tick.telemetry.probe_m) {
        coordinate += 0.001F;
      }
      file->append(std::span(&tick, 1));
    }
    file->finish();
    return path;
  }
  [[nodiscard]] std::string refusal(const std::filesystem::path& file) const {
    const auto text =
        test::message_of<std::runtime_error>([&] { (void)read_recorded_motion(file); });
    return text.substr(std::min(text.size(), file.string().size()));
  }
};

TEST_F(RecordedMotionTest, HasActiveTicksFromTimeZero) {
  for (const char* name : {"session.csv", "session.npz"}) {
    const auto file = record(name, {State::kIdle, State::kArmed, State::kActive, State::kActive,
                                    State::kFault, State::kActive});
    EXPECT_TRUE(is_recording(file));
    const std::vector<RecordedTick> ticks = read_recorded_motion(file);
    ASSERT_EQ(ticks.size(), 3U) << name;
    EXPECT_EQ(ticks[0].t_s, 0.0);
    EXPECT_NEAR(ticks[1].t_s, 0.001, 1e-12);
    EXPECT_NEAR(ticks[2].t_s, 0.003, 1e-12);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(ticks[0].probe_m[axis], 0.003, 1e-8);
      EXPECT_NEAR(ticks[2].probe_m[axis], 0.006, 1e-8);
    }
  }
}

TEST_F(RecordedMotionTest, BeginsWithoutContact) {
  const std::string header = "t_s,probe_x_m,probe_y_m,probe_z_m,in_contact\n";
  const auto ticks = read_recorded_motion(
      write("free.csv", header + "1,1,0,0,1\n2,2,0,0,0\n3,3,0,0,1\n4,4,0,0,0\n"));
  ASSERT_EQ(ticks.size(), 3U);
  EXPECT_EQ(ticks[0].t_s, 0.0);
  EXPECT_EQ(ticks[0].probe_m[0], 2.0);
  EXPECT_FALSE(ticks[0].in_contact);
  EXPECT_TRUE(ticks[1].in_contact);
  EXPECT_EQ(read_recorded_motion(write("held.csv", header + "1,1,0,0,1\n2,2,0,0,1\n")).size(), 2U);
}

TEST_F(RecordedMotionTest, HasAllTicksWithoutStates) {
  const auto file =
      write("bare.csv", "t_s,probe_x_m,probe_y_m,probe_z_m\n1,0.1,0.2,0.3\n2,0.4,0.5,0.6\n");
  EXPECT_TRUE(is_recording(file));
  const std::vector<RecordedTick> ticks = read_recorded_motion(file);
  ASSERT_EQ(ticks.size(), 2U);
  EXPECT_EQ(ticks[1].t_s, 1.0);
  EXPECT_EQ(ticks[1].probe_m, (std::array<double, 3>{0.4, 0.5, 0.6}));
}

TEST_F(RecordedMotionTest, KnowsRecordingsByColumns) {
  EXPECT_FALSE(is_recording(write("path.csv", "t_s,x,y,z\n0,0,0,0\n")));
  EXPECT_FALSE(is_recording(write("empty.csv", "")));
  EXPECT_FALSE(is_recording(folder_));
  EXPECT_FALSE(is_recording(""));
}

TEST_F(RecordedMotionTest, RefusesWithPlaceAndRemedy) {
  for (const char* name : {"idle.csv", "idle.npz"}) {
    EXPECT_EQ(refusal(record(name, {State::kIdle, State::kFault})),
              ": no tick is in the state active, in which the hand feels the model (arm the board "
              "while it is recorded: record --arm)");
  }
  EXPECT_EQ(refusal(write("no_z.csv", "t_s,probe_x_m,probe_y_m\n0,0,0\n")),
            ": line 1: the header has no column probe_z_m (give a file of tactree record or of "
            "simulate --trace)");
  const std::string header = "t_s,probe_x_m,probe_y_m,probe_z_m\n";
  EXPECT_EQ(refusal(write("back.csv", header + "1,0,0,0\n1,0,0,0\n")),
            ": line 3: t_s does not increase (give a file of tactree record or of simulate "
            "--trace)");
  EXPECT_NE(refusal(write("nan.csv", header + "1,0,nan,0\n")).find(": line 2: "),
            std::string::npos);
}

}  // namespace
}  // namespace tactree::telemetry
