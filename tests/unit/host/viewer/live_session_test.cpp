// A simulated session driven by the commands of a page.

#include "tactree/viewer/live_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

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
  static constexpr double kPressed_m = kRadius_m - 0.01;

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
  static double force_of(const json& frame) {
    const json& f = frame["runs"][0]["force_N"];
    return Eigen::Vector3d(f[0], f[1], f[2]).norm();
  }
  void press() { say({{"do", "hand"}, {"target_m", {0.0, 0.0, kPressed_m}}}); }
  /// The frame after 1 s, in which the device comes to rest.
  json settled() {
    const double begin_s = json::parse(session_.step())["t_s"];
    return wait_for([&](const json& f) { return f["t_s"] > begin_s + 1.0; });
  }
  struct Tick {
    double t_s;
    double force_N;
  };
  /// The ticks of the trace; the last 500 may be missing.
  std::vector<Tick> recorded() {
    std::vector<Tick> ticks;
    std::istringstream csv(session_.trace_csv());
    std::string line;
    std::getline(csv, line);
    while (std::getline(csv, line)) {
      std::vector<double> row;
      std::istringstream cells(line);
      for (std::string cell; row.size() < 10 && std::getline(cells, cell, ',');) {
        row.push_back(std::stod(cell));
      }
      ticks.push_back({row.at(0), Eigen::Vector3d(row.at(7), row.at(8), row.at(9)).norm()});
    }
    return ticks;
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
  EXPECT_TRUE(frame["runs"][0]["faults"][0]["about"].get<std::string>().starts_with(
      "The emergency stop input is open. Make the area safe"));
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
    say({{"do", "set"}, {"restart", true}});
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

TEST_F(LiveSessionTest, StiffnessChangesUnderPressingHand) {
  wait_for_state("active");
  press();
  const json before = settled();
  say({{"do", "set"}, {"stiffness_N_m", 1000}});
  const json after = settled();
  EXPECT_EQ(after["settings"]["stiffness_N_m"], 1000.0);
  EXPECT_GT(force_of(after), 1.15 * force_of(before));
  EXPECT_LT(after["runs"][0]["penetration_m"].get<double>(),
            0.75 * before["runs"][0]["penetration_m"].get<double>());
  EXPECT_NEAR(after["hand_m"][2].get<double>(), kPressed_m, 1e-6);
  const std::vector<Tick> ticks = recorded();
  EXPECT_EQ(ticks.front().t_s, 0.0);
  double step_max_N = 0.0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    ASSERT_NEAR(ticks[i].t_s - ticks[i - 1].t_s, 1e-3, 1e-6);
    if (ticks[i].t_s >= before["t_s"]) {
      ASSERT_GT(ticks[i].force_N, 0.9 * force_of(before)) << ticks[i].t_s;
      step_max_N = std::max(step_max_N, std::abs(ticks[i].force_N - ticks[i - 1].force_N));
    }
  }
  EXPECT_LT(step_max_N, 0.05);
}

TEST_F(LiveSessionTest, TextureChangesUnderPressingHand) {
  wait_for_state("active");
  say({{"do", "set"}, {"static_friction", 0.0}, {"dynamic_friction", 0.0}});
  // Between two bumps 2 mm apart.
  say({{"do", "hand"}, {"target_m", {1e-3, 0.0, kPressed_m}}});
  const auto depth_m = [](const json& f) { return f["runs"][0]["penetration_m"].get<double>(); };
  const json before = settled();
  say({{"do", "set"}, {"texture_height_m", 5e-4}});
  const json deep = settled();
  EXPECT_GT(depth_m(deep), depth_m(before) + 2e-4);
  EXPECT_LT(force_of(deep), 0.98 * force_of(before));
  EXPECT_NEAR(deep["settings"]["texture_height_m"].get<double>(), 5e-4, 1e-9);
  say({{"do", "set"}, {"texture_wavelength_m", 5e-3}});  // now nearer to a bump
  EXPECT_LT(depth_m(settled()), depth_m(deep) - 1e-4);
  say({{"do", "set"}, {"texture_height_m", 0.0}});
  EXPECT_NEAR(depth_m(settled()), depth_m(before), 5e-5);  // dry friction of the device
  const std::vector<Tick> ticks = recorded();
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (ticks[i].t_s >= before["t_s"]) {
      ASSERT_LT(std::abs(ticks[i].force_N - ticks[i - 1].force_N), 0.05) << ticks[i].t_s;
    }
  }
  EXPECT_NE(refusal({{"do", "set"}, {"texture_height_m", 0.02}}).find("texture_height_m"),
            std::string::npos);
}

TEST_F(LiveSessionTest, KeepsSessionUnlessRateOrDeviceChanges) {
  wait_for_state("active");
  say({{"do", "hand"}, {"target_m", {0.0, 0.0, 2.0 * kRadius_m}}});
  json before = wait_for([](const json& f) { return f["t_s"] > 0.6; });
  const std::vector<std::pair<std::string, json>> changes = {
      {"damping_Ns_m", 1.0},     {"static_friction", 0.75},
      {"dynamic_friction", 0.5}, {"texture_wavelength_m", 0.25},
      {"force_max_N", 0.5},      {"use_materials", false},
      {"mode", "both"},          {"mode", "paper"},
      {"mode", "surface"}};
  for (const auto& change : changes) {
    const std::string& name = change.first;
    say({{"do", "set"}, {name, change.second}});
    const double begin_s = before["t_s"];
    before = wait_for([&](const json& f) {
      EXPECT_GE(f["t_s"], begin_s) << name;
      EXPECT_NEAR(f["hand_m"][2].get<double>(), 2.0 * kRadius_m, 1e-6) << name;
      const double tip_m = f["runs"][0]["tip_m"][2];
      EXPECT_GT(tip_m, 1.9 * kRadius_m) << name;
      return f["t_s"] > begin_s + 0.2 && f["runs"][0]["state"] == "active";
    });
    EXPECT_EQ(before["settings"][name], change.second);
  }
  EXPECT_EQ(recorded().front().t_s, 0.0);
}

TEST_F(LiveSessionTest, MaximumForceActsAfterChange) {
  wait_for_state("active");
  say({{"do", "set"}, {"force_max_N", 0.5}});
  wait_for([](const json& f) { return f["t_s"] > 1.0 && f["runs"][0]["state"] == "active"; });
  press();
  EXPECT_NEAR(force_of(settled()), 0.5, 1e-3);
  EXPECT_NE(refusal({{"do", "set"}, {"force_max_N", 80}}).find("the limit of premium"),
            std::string::npos);
}

TEST_F(LiveSessionTest, LimitChangeWaitsForFreeSpace) {
  wait_for_state("active");
  press();
  settled();
  say({{"do", "set"}, {"force_max_N", 4.0}});
  wait_for_news("the probe is inside the object");
  say({{"do", "hand"}, {"target_m", {0.0, 0.0, 2.0 * kRadius_m}}});
  wait_for_state("active");
}

TEST_F(LiveSessionTest, MaterialsActAfterChange) {
  builder::Model soft = sphere(kRadius_m, 0.001);
  core::BlobMaterial material{};
  material.stiffness_N_m = 100.0F;
  soft.materials = {material};
  const TestBlob blob(soft);
  simulation::SceneBody body;
  body.blob = blob.written().bytes;
  LiveSession session({{blob.view()}, {body}}, devices(), {});
  const auto force_N = [&](bool use_materials) {
    EXPECT_FALSE(session.command({{"do", "set"}, {"use_materials", use_materials}}));
    EXPECT_FALSE(session.command({{"do", "hand"}, {"target_m", {0.0, 0.0, 2.0 * kRadius_m}}}));
    json frame;
    for (int i = 0; i < 60; ++i) {
      frame = json::parse(session.step());
    }
    EXPECT_EQ(frame["runs"][0]["state"], "active");
    EXPECT_FALSE(session.command({{"do", "hand"}, {"target_m", {0.0, 0.0, kPressed_m}}}));
    for (int i = 0; i < 60; ++i) {
      frame = json::parse(session.step());
    }
    return force_of(frame);
  };
  const double with_N = force_N(true);
  EXPECT_GT(force_N(false), 1.5 * with_N);
  EXPECT_NEAR(force_N(true), with_N, 0.02 * with_N);
}

TEST_F(LiveSessionTest, StopEndsChangeDisarmed) {
  wait_for_state("active");
  say({{"do", "set"}, {"force_max_N", 4.0}});
  say({{"do", "stop"}});
  const double begin_s = wait_for_state("idle")["t_s"];
  wait_for([&](const json& f) {
    EXPECT_EQ(f["runs"][0]["state"], "idle");
    return f["t_s"] > begin_s + 1.0;
  });
  say({{"do", "set"}, {"mode", "paper"}});
  const json frame = wait_for([&](const json& f) { return f["t_s"] > begin_s + 2.0; });
  EXPECT_EQ(frame["runs"][0]["mode"], "paper");
  EXPECT_EQ(frame["runs"][0]["state"], "idle");
}

TEST_F(LiveSessionTest, InjectedFaultSurvivesModeChange) {
  wait_for_state("active");
  say({{"do", "inject"}, {"fault", "estop:pressed"}});
  wait_for_state("fault");
  say({{"do", "set"}, {"mode", "paper"}});
  wait_for([](const json& f) {
    return f["runs"][0]["mode"] == "paper" && f["runs"][0]["state"] == "fault";
  });
}

TEST_F(LiveSessionTest, RateAndDeviceRestartOnRequestOnly) {
  wait_for([](const json& f) { return f["t_s"] > 0.6; });
  EXPECT_NE(refusal({{"do", "set"}, {"rate_hz", 2000}}).find("\"restart\": true"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "set"}, {"device", "falcon"}}).find("\"restart\": true"),
            std::string::npos);
  const json same = json::parse(session_.step());
  EXPECT_GT(same["t_s"], 0.6);
  EXPECT_EQ(same["settings"]["rate_hz"], 1000.0);
  say({{"do", "set"}, {"rate_hz", 2000}, {"restart", true}});
  say({{"do", "set"}, {"damping_Ns_m", 2.0}});
  const json other = json::parse(session_.step());
  EXPECT_LT(other["t_s"], 0.1);
  EXPECT_EQ(other["settings"]["rate_hz"], 2000.0);
  EXPECT_EQ(other["settings"]["damping_Ns_m"], 2.0);
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

TEST_F(LiveSessionTest, ReportsAndScalesUnreachableModel) {
  std::string scaled_for;
  const viewer::Placing placing = {
      [](const viewer::NamedDevice& device, const std::optional<simulation::Placement>& placement) {
        EXPECT_FALSE(placement);
        return device.name == "falcon" ? std::optional<std::string>("too large") : std::nullopt;
      },
      [](const simulation::Placement&) {},
      [&](const viewer::NamedDevice& device, const simulation::Placement& now) {
        scaled_for = device.name;
        EXPECT_EQ(now.scale, 1.0);
      }};
  LiveSession session(bodies(), devices(), {}, placing);
  EXPECT_EQ(json::parse(session.step())["fit"], json({{"warning", ""}, {"can_scale", false}}));
  EXPECT_TRUE(session.command({{"do", "fit"}}));
  EXPECT_FALSE(session.command({{"do", "set"}, {"device", "falcon"}, {"restart", true}}));
  const json fit = json::parse(session.step())["fit"];
  EXPECT_TRUE(fit["warning"].get<std::string>().starts_with("model: too large")) << fit;
  EXPECT_TRUE(fit["can_scale"]);
  EXPECT_EQ(session.settings().device, "falcon");
  EXPECT_FALSE(session.command({{"do", "fit"}}));
  EXPECT_EQ(scaled_for, "falcon");
  session.report("The model is being scaled.");
  EXPECT_EQ(json::parse(session.step())["news"]["text"], "The model is being scaled.");
}

/// A session whose only model can be placed.
class PlacedSessionTest : public LiveSessionTest {
 protected:
  viewer::Placing placing() {
    return {[this](const viewer::NamedDevice&, const auto& placement) {
              told_ = placement;
              return std::optional<std::string>();
            },
            [this](const simulation::Placement& wanted) { renewed_ = wanted; },
            {}};
  }
  static json turned_about_x(double x, double y, double z) {
    return {1, 0, 0, x, 0, 0, -1, y, 0, 1, 0, z, 0, 0, 0, 1};
  }
  json step() { return json::parse(placed_.step()); }
  json settle() {
    const double begin_s = step()["t_s"];
    json frame;
    do {
      frame = step();
    } while (frame["t_s"] < begin_s + 1.0);
    return frame;
  }
  std::string answer(const json& command) { return placed_.command(command).value_or(""); }

  std::optional<simulation::Placement> told_;
  std::optional<simulation::Placement> renewed_;
  LiveSession placed_{bodies(), devices(), {}, placing()};
};

TEST_F(PlacedSessionTest, ModelMovesUnderRunningSession) {
  settle();
  EXPECT_EQ(answer({{"do", "hand"}, {"target_m", {0.0, 0.0, kRadius_m + 0.02}}}), "");
  const json before = settle();
  EXPECT_EQ(force_of(before), 0.0);
  EXPECT_FALSE(told_);
  // Over the hand, which is then 4 mm inside.
  EXPECT_EQ(answer({{"do", "place"}, {"pose", turned_about_x(0.0, 0.0, 0.024)}}), "");
  ASSERT_TRUE(told_);
  EXPECT_NEAR(told_->pose.translation().z(), 0.024, 1e-9);
  const json moved = step();
  EXPECT_NEAR(moved["bodies"][0][11].get<double>(), 0.024, 1e-7);
  EXPECT_NEAR(moved["bodies"][0][9].get<double>(), 1.0, 1e-7);
  const json pose = turned_about_x(0.0, 0.0, 0.024);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    EXPECT_NEAR(moved["place"]["pose"][i].get<double>(), pose[i].get<double>(), 1e-9) << i;
  }
  EXPECT_EQ(moved["place"]["scale"], 1.0);
  EXPECT_GT(moved["t_s"], before["t_s"]);
  EXPECT_NEAR(moved["hand_m"][2].get<double>(), kRadius_m + 0.02, 1e-6);
  EXPECT_EQ(moved["runs"][0]["state"], "active");
}

TEST_F(PlacedSessionTest, PlacedModelIsTouchedWhereItIs) {
  settle();
  EXPECT_EQ(answer({{"do", "place"}, {"pose", turned_about_x(0.03, 0.0, 0.0)}}), "");
  EXPECT_EQ(answer({{"do", "hand"}, {"target_m", {0.03, 0.0, 2.0 * kRadius_m}}}), "");
  settle();
  EXPECT_EQ(answer({{"do", "hand"}, {"target_m", {0.03, 0.0, kPressed_m}}}), "");
  const json frame = settle();
  const json& force = frame["runs"][0]["force_N"];
  EXPECT_GT(force[2].get<double>(), 0.5);
  EXPECT_LT(std::abs(force[0].get<double>()), 0.1);
}

TEST_F(PlacedSessionTest, PlaceStaysAfterRestartAndChangeOfMode) {
  settle();
  EXPECT_EQ(answer({{"do", "place"}, {"pose", turned_about_x(0.03, 0.0, 0.0)}}), "");
  EXPECT_EQ(answer({{"do", "set"}, {"mode", "both"}}), "");
  step();
  EXPECT_EQ(answer({{"do", "set"}, {"rate_hz", 2000}, {"restart", true}}), "");
  const json frame = step();
  EXPECT_NEAR(frame["bodies"][0][3].get<double>(), 0.03, 1e-7);
  const json hello = json::parse(placed_.hello());
  EXPECT_EQ(hello["hand_start_m"], frame["place"]["hand_start_m"]);
  const json& hand = frame["hand_m"];
  const json& start = frame["place"]["hand_start_m"];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(hand[axis].get<double>(), start[axis].get<double>(), 1e-3);
  }
  // The start is over the model: along its z, which is -y of the device.
  EXPECT_NEAR(start[0].get<double>(), 0.03, 3e-3);
  EXPECT_LT(start[1].get<double>(), -kRadius_m);
}

TEST_F(PlacedSessionTest, OtherSizeRestartsOnlyWhenAsked) {
  const json pose = turned_about_x(0.0, 0.0, 0.01);
  const json command = {{"do", "place"}, {"pose", pose}, {"scale", 1.5}};
  EXPECT_NE(answer(command).find("\"restart\": true"), std::string::npos);
  EXPECT_FALSE(renewed_);
  json confirmed = command;
  confirmed["restart"] = true;
  EXPECT_EQ(answer(confirmed), "");
  ASSERT_TRUE(renewed_);
  EXPECT_EQ(renewed_->scale, 1.5);
  EXPECT_EQ(renewed_->pose.translation().z(), 0.01);
  EXPECT_EQ(step()["place"]["scale"], 1.0) << "the program begins the new session";
}

TEST_F(PlacedSessionTest, RefusedPlacesChangeNothing) {
  const json before = step()["place"];
  json scaled = turned_about_x(0, 0, 0);
  scaled[0] = 2.0;
  json far = turned_about_x(0, 0, 6.0);
  json text = turned_about_x(0, 0, 0);
  text[3] = "far";
  for (const json& pose : {scaled, far, text, json(3), json::array({1, 2})}) {
    EXPECT_NE(answer({{"do", "place"}, {"pose", pose}}).find("pose: "), std::string::npos) << pose;
  }
  EXPECT_NE(answer({{"do", "place"}}).find("pose: "), std::string::npos);
  for (const json& scale : {json(0), json(-1), json("large"), json(1e9)}) {
    const json command = {{"do", "place"}, {"pose", turned_about_x(0, 0, 0)}, {"scale", scale}};
    EXPECT_NE(answer(command).find("scale: "), std::string::npos) << scale;
  }
  EXPECT_EQ(step()["place"], before);
}

TEST_F(PlacedSessionTest, OriginOfSettingsIsFrameOfDevice) {
  viewer::Settings settings;
  settings.origin_m = core::Vec3{0.0F, 0.0F, 0.0F};
  settings.scale = 0.5;
  viewer::Bodies placed = bodies();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.02, 0.01, 0.0);
  placed.bodies[0].path = simulation::BodyPath(pose);
  LiveSession session(std::move(placed), devices(), settings, placing());
  const json place = json::parse(session.step())["place"];
  EXPECT_EQ(place["pose"], json(simulation::rows_of(pose)));
  EXPECT_EQ(place["scale"], 0.5);
  EXPECT_EQ(place["origin_m"], json({0.0, 0.0, 0.0}));
  ASSERT_TRUE(told_);
  EXPECT_EQ(told_->scale, 0.5);
}

TEST_F(PlacedSessionTest, ReachIsDrawnAroundDevice) {
  const json reach = json::parse(placed_.reach_json());
  ASSERT_EQ(reach["points_m"].size(),
            reach["rows"].get<std::size_t>() * reach["columns"].get<std::size_t>());
  EXPECT_GT(reach["points_m"].back()[2].get<double>(), 0.02);
}

TEST_F(LiveSessionTest, SceneCannotBePlaced) {
  EXPECT_NE(refusal({{"do", "place"}, {"pose", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}})
                .find("single model"),
            std::string::npos);
  EXPECT_FALSE(json::parse(session_.step()).contains("place"));
}

TEST_F(LiveSessionTest, ReportsUnreachableStartOfHand) {
  EXPECT_EQ(session_.warning(), "");
  const TestBlob large(sphere(0.5, 0.02));
  simulation::SceneBody body;
  body.blob = large.written().bytes;
  const LiveSession session({{large.view()}, {body}}, devices(), {});
  EXPECT_EQ(session.warning(),
            "premium does not reach the start of the hand: the probe may begin in the object");
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
