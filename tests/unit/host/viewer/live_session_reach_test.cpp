// What a page is told of a hand that the device or the method does not feel.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactree/viewer/live_session.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

using nlohmann::json;
using viewer::LiveSession;

constexpr double kRadius_m = 0.04;

std::vector<viewer::NamedDevice> preset_devices() {
  std::vector<viewer::NamedDevice> list;
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    list.push_back({preset.name, preset.about, preset});
  }
  return list;
}

TEST(LiveSessionReach, ReportsUnreachableStartOfPaddle) {
  const TestBlob ball(sphere(kRadius_m, 0.002));
  const Eigen::Vector3d aside(0.0, 0.2, 0.0);
  simulation::SceneBody body;
  body.blob = ball.written().bytes;
  body.path = simulation::BodyPath(Eigen::Isometry3d(Eigen::Translation3d(aside)));
  viewer::Settings settings;
  settings.device = "hapkit";
  const LiveSession near({{ball.view()}, {body}}, preset_devices(), settings);
  EXPECT_EQ(near.warning(), "");
  settings.origin_m = core::Vec3{};
  const LiveSession session({{ball.view()}, {body}}, preset_devices(), settings);
  EXPECT_EQ(session.warning(),
            "hapkit does not reach the start of the hand: the probe may begin in the object");
}

TEST(LiveSessionReach, WarningBeginsWithNameOfModel) {
  builder::Model model = sphere(0.5, 0.02);
  model.name = "large";
  const TestBlob large(model);
  simulation::SceneBody body;
  body.blob = large.written().bytes;
  LiveSession session({{large.view()}, {body}}, preset_devices(), {});
  EXPECT_EQ(json::parse(session.step())["fit"]["warning"], "large: " + session.warning());
}

TEST(LiveSessionReach, ExplainsHandBehindPointsInPaperMode) {
  builder::Model model = sphere(kRadius_m, 0.002);
  model.tells_interior = true;
  const TestBlob ball(model);
  simulation::SceneBody body;
  body.blob = ball.written().bytes;
  viewer::Settings settings;
  settings.modes = viewer::Modes::kBoth;
  LiveSession session({{ball.view()}, {body}}, preset_devices(), settings);
  json runs;
  const auto settle_at = [&](double height_m) {
    EXPECT_FALSE(session.command({{"do", "hand"}, {"target_m", {0.0, 0.0, height_m}}}));
    for (int i = 0; i < 200; ++i) {
      runs = json::parse(session.step())["runs"];
    }
  };
  settle_at(kRadius_m + 0.004);
  EXPECT_EQ(runs[1]["note"], "");
  for (const double depth_m : {0.0025, 0.02}) {  // near the points, and beyond their reach
    settle_at(kRadius_m - depth_m);
    EXPECT_EQ(runs[0]["note"], "");
    const std::string note = runs[1]["note"];
    EXPECT_NE(note.find("only within 1 mm of a point"), std::string::npos) << note;
    EXPECT_NE(note.find("choose the mode surface"), std::string::npos) << note;
  }
}

}  // namespace
}  // namespace tactree::test
