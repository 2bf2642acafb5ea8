// A simulated session driven by the commands of a page.

#include "tactree/viewer/live_session.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "frames.hpp"
#include "tactree/simulation/injection.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

using nlohmann::json;
using viewer::LiveSession;

class LiveSessionTest : public testing::Test {
 protected:
  static constexpr double kRadius_m = 0.04;

  static std::vector<viewer::NamedDevice> devices() {
    std::vector<viewer::NamedDevice> list;
    for (const core::DevicePreset& preset : core::kDevicePresets) {
      list.push_back({preset.name, preset.about, preset});
    }
    return list;
  }
  viewer::Bodies bodies() {
    simulation::SceneBody body;
    body.blob = blob_.written().bytes;
    return {{blob_.view()}, {body}};
  }
  void say(const json& command) { EXPECT_EQ(session_.command(command).value_or(""), ""); }
  /// The first of the next frames for which this holds; the session's time passes meanwhile.
  json wait_for(const std::function<bool(const json&)>& holds) {
    json frame;
    for (int i = 0; i < 3000; ++i) {
      frame = json::parse(session_.step());
      if (holds(frame)) {
        return frame;
      }
    }
    ADD_FAILURE() << "it never happened: " << frame.dump().substr(0, 600);
    return frame;
  }
  json wait_for_state(const std::string& state) {
    return wait_for([&](const json& frame) { return frame["runs"][0]["state"] == state; });
  }
  std::string wait_for_news(const std::string& text) {
    const json frame = wait_for([&](const json& f) {
      return f["news"]["text"].get<std::string>().find(text) != std::string::npos;
    });
    return frame["news"]["text"];
  }
  std::string refusal(const json& command) {
    return session_.command(command).value_or("accepted");
  }

  TestBlob blob_{sphere(kRadius_m, 0.001)};
  LiveSession session_{bodies(), devices(), {}};
};

TEST_F(LiveSessionTest, SurfaceForceActsUntilStopped) {
  wait_for_state("active");
  say({{"do", "hand"}, {"target_m", {0.0, 0.0, kRadius_m - 0.01}}});
  const json frame =
      wait_for([](const json& f) { return f["runs"][0]["force_N"][2].get<double>() > 0.5; });
  const json& run = frame["runs"][0];
  EXPECT_NEAR(core::length({run["proxy_m"][0], run["proxy_m"][1], run["proxy_m"][2]}),
              static_cast<float>(kRadius_m), 2e-4F);
  EXPECT_GT(run["penetration_m"].get<double>(), 5e-4);
  EXPECT_GT(run["candidates"].size(), 5U);
  EXPECT_GE(run["strip"]["force_N"][1], run["strip"]["force_N"][0]);
  say({{"do", "stop"}});
  const json idle = wait_for_state("idle");
  EXPECT_EQ(idle["runs"][0]["force_N"], json({0.0, 0.0, 0.0}));
}

TEST_F(LiveSessionTest, ClearsFaultOnceCauseEnds) {
  wait_for_state("active");
  say({{"do", "inject"}, {"fault", "estop:pressed"}});
  const json frame = wait_for_state("fault");
  EXPECT_EQ(frame["runs"][0]["faults"][0]["name"], "emergency-stop");
  say({{"do", "clear_injections"}});
  say({{"do", "clear"}});
  wait_for_state("idle");
  say({{"do", "arm"}});
  wait_for_state("active");
}

TEST_F(LiveSessionTest, ReportsClearWithPersistingCause) {
  wait_for_state("active");
  say({{"do", "inject"}, {"fault", "estop:pressed"}});
  wait_for_state("fault");
  say({{"do", "clear"}});
  const std::string cleared = wait_for_news("Not cleared");
  EXPECT_NE(cleared.find("emergency-stop"), std::string::npos) << cleared;
  EXPECT_NE(cleared.find("estop:pressed"), std::string::npos) << cleared;
  say({{"do", "arm"}});
  wait_for_news("Not armed: the fault emergency-stop is latched");
}

TEST_F(LiveSessionTest, ReportsArmingInsideObject) {
  wait_for_state("active");
  say({{"do", "stop"}});
  wait_for_state("idle");
  say({{"do", "hand"}, {"target_m", {0.0, 0.0, 0.75 * kRadius_m}}});
  wait_for([](const json& f) { return f["runs"][0]["probe_m"][2] < 0.9 * kRadius_m; });
  say({{"do", "arm"}});
  wait_for_news("the probe is inside the object");
}

TEST_F(LiveSessionTest, InjectionsShowEffectOrReason) {
  const json injections = json::parse(session_.hello())["injections"];
  EXPECT_EQ(injections.size(), simulation::injection_kinds().size());
  for (const json& one : injections) {
    say({{"do", "set"}, {"damping_Ns_m", 0.5}});  // a new session
    wait_for([](const json& f) { return f["t_s"] < 0.2; });
    const json before =
        wait_for([](const json& f) { return f["runs"][0]["state"] == "active" && f["t_s"] > 0.4; });
    say({{"do", "inject"}, {"fault", one["fault"]}});
    wait_for([&](const json& f) {
      return f["runs"][0]["state"] != "active" || f["runs"][0]["overruns"] > 0 ||
             (f["news"]["number"] != before["news"]["number"] &&
              f["news"]["text"].get<std::string>().starts_with(one["fault"].get<std::string>()));
    });
    EXPECT_FALSE(HasFailure()) << one;
  }
}

TEST_F(LiveSessionTest, HandVisitsPlacesOnPath) {
  wait_for_state("active");
  const Eigen::Vector3d aside(0.0, 0.08, 0.0);
  const auto is_near = [](const json& f, const Eigen::Vector3d& place) {
    const json& hand = f["hand_m"];
    return (Eigen::Vector3d(hand[0], hand[1], hand[2]) - place).norm() < 2e-3;
  };
  const Eigen::Vector3d end(0.0, 0.0, -0.06);
  say({{"do", "hand"},
       {"target_m", {end.x(), end.y(), end.z()}},
       {"via_m", {{aside.x(), aside.y(), aside.z()}}}});
  wait_for([&](const json& f) {
    EXPECT_EQ(f["runs"][0]["force_N"], json({0.0, 0.0, 0.0}));
    return is_near(f, aside);
  });
  wait_for([&](const json& f) { return is_near(f, end); });
}

TEST_F(LiveSessionTest, RunsBothModesTogether) {
  say({{"do", "set"}, {"mode", "both"}});
  const json frame = wait_for([](const json& f) { return f["runs"].size() == 2; });
  EXPECT_EQ(frame["runs"][0]["mode"], "surface");
  EXPECT_EQ(frame["runs"][1]["mode"], "paper");
}

TEST_F(LiveSessionTest, ChangedSettingsRestartOutsideObject) {
  wait_for_state("active");
  say({{"do", "hand"}, {"target_m", {0.0, 0.0, kRadius_m - 0.01}}});
  wait_for([](const json& f) { return f["runs"][0]["force_N"][2].get<double>() > 0.5; });
  say({{"do", "set"}, {"damping_Ns_m", 1.0}});
  const json frame = wait_for(
      [](const json& f) { return f["settings"]["damping_Ns_m"] == 1.0 && f["t_s"] > 0.0; });
  EXPECT_EQ(frame["runs"][0]["penetration_m"], 0.0);
  wait_for_state("active");
}

TEST_F(LiveSessionTest, RefusedCommandsChangeNothing) {
  EXPECT_NE(refusal({{"do", "set"}, {"stiffness_N_m", 50000}}).find("stability limit"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "set"}, {"rate_hz", 1}}).find("rate_hz"), std::string::npos);
  EXPECT_NE(refusal({{"do", "set"}, {"device", "none"}}).find("'none' is unknown"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "set"}, {"colour", "red"}}).find("unknown setting"), std::string::npos);
  EXPECT_NE(refusal({{"do", "jump"}}).find("unknown command"), std::string::npos);
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {1, 2}}}), "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {1e30, 0, 0}}}), "accepted");
  const json places = json::array({{0, 0, 0}});
  EXPECT_EQ(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"via_m", places}}), "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"via_m", 3}}), "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"via_m", {{0, 0}}}}), "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"via_m", json(65, places[0])}}),
            "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"speed_m_s", 0}}), "accepted");
  EXPECT_NE(refusal({{"do", "hand"}, {"target_m", {0, 0, 0.1}}, {"speed_m_s", 9}}), "accepted");
  const json hello = json::parse(session_.hello());
  EXPECT_EQ(hello["settings"]["stiffness_N_m"], 500.0);
  EXPECT_EQ(hello["settings"]["rate_hz"], 1000.0);
}

TEST_F(LiveSessionTest, RecordsTrace) {
  wait_for([](const json& f) { return f["t_s"].get<double>() > 0.7; });
  const std::string csv = session_.trace_csv();
  EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 500);
}

TEST_F(LiveSessionTest, RunsInRealTime) {
  Frames frames;
  session_.start(frames.taker());
  frames.wait_for_state("active");
  session_.stop();
}

}  // namespace
}  // namespace tactree::test
