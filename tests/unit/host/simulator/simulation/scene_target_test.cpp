// Bodies follow their paths in step with the simulation's time, here and over the link.

#include "tactree/simulation/scene_target.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "poses.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

using simulation::BodyPath;
using simulation::HandPath;
using simulation::HostTarget;
using simulation::LinkedBodyTarget;
using simulation::SceneBody;
using simulation::SceneTarget;
using simulation::Simulation;
using SimSetup = simulation::Setup;

const Shape& sheet() {
  static const Shape shape = plane();
  return shape;
}

SceneBody body_on(BodyPath path, const Shape& shape = sheet()) {
  SceneBody body;
  body.blob = shape.bytes();
  body.path = std::move(path);
  return body;
}

std::unique_ptr<SceneTarget> scene_of(std::vector<SceneBody> bodies) {
  return std::make_unique<SceneTarget>(std::move(bodies), Simulation::arming_ticks({}));
}

HandPath still(double z) { return HandPath({{0.0, {0.0, 0.0, z}}}); }
HandPath rub() { return simulation::make_script("rub", sheet().view(), 1.0); }

simulation::Summary run(std::unique_ptr<simulation::Target> target, HandPath path) {
  Simulation sim(sheet().bytes(), {}, std::move(path), std::move(target));
  EXPECT_TRUE(sim.start_result().ok());
  EXPECT_TRUE(sim.arm());
  simulation::Recorder recorder;
  for (int i = 0; i < 1000; ++i) {
    recorder.add(sim.step());
  }
  return recorder.summary();
}

/// Time of the first sample in contact and of the first one after it that is not; -1: none.
std::pair<double, double> contact_of(std::vector<SceneBody> bodies) {
  Simulation sim(sheet().bytes(), {}, still(0.002), scene_of(std::move(bodies)));
  EXPECT_TRUE(sim.arm());
  double begin = -1.0;
  double end = -1.0;
  for (int i = 0; i < 1000; ++i) {
    const simulation::Sample sample = sim.step();
    const bool contact = sample.status.rendering.in_contact;
    begin = contact && begin < 0.0 ? sample.t_s : begin;
    end = !contact && begin >= 0.0 && end < 0.0 ? sample.t_s : end;
  }
  return {begin, end};
}

const Eigen::Vector3d kUp(0.0, 0.0, 0.01);
const Eigen::Vector3d kNoTurn = Eigen::Vector3d::Zero();

TEST(SceneTarget, RestingBodyEqualsPlainModel) {
  const auto alone = run(std::make_unique<HostTarget>(), rub());
  const auto in_a_scene = run(scene_of({body_on(BodyPath())}), rub());
  EXPECT_GT(alone.contact_ticks, 100U);
  EXPECT_EQ(in_a_scene.trace_crc32, alone.trace_crc32);
}

// The sheet rises by 1 cm/s from below: after 0.4 s it is at the probe, 2 mm up; there is no time
// before the first tick.
TEST(SceneTarget, TimeStartsAfterArming) {
  const SceneBody rising = body_on(BodyPath(isometry({0.0, 0.0, -0.002}), kUp, kNoTurn));
  EXPECT_NEAR(contact_of({rising}).first, 0.4, 0.01);
  const BodyPath keyframes({{0.1, isometry({0.0, 0.0, 0.0})}, {1.1, isometry({0.0, 0.0, 0.01})}});
  EXPECT_NEAR(contact_of({body_on(keyframes)}).first, 0.3, 0.01);
}

TEST(SceneTarget, EnablesBodyWithinItsTimes) {
  SceneBody second = body_on(BodyPath(isometry({0.0, 0.0, -0.002}), kUp, kNoTurn));
  second.until_s = 0.6;
  const auto [begin, end] = contact_of({body_on(BodyPath(isometry({0.0, 0.0, -1.0}))), second});
  EXPECT_NEAR(begin, 0.4, 0.01);
  EXPECT_NEAR(end, 0.6, 1.5e-3);
  second.from_s = 0.7;
  second.until_s = 0.8;
  EXPECT_EQ(contact_of({second}).first, -1.0);  // it appears around the probe: no contact
}

TEST(SceneTarget, NamesRefusedBody) {
  const Shape for_paper = plane(0.01).paper_twin();
  auto target = scene_of({body_on(BodyPath()), body_on(BodyPath(), for_paper)});
  const SceneTarget& scene = *target;
  Simulation sim(sheet().bytes(), {}, still(0.01), std::move(target));
  EXPECT_EQ(sim.start_result().model, core::ModelStatus::kNoReach);
  EXPECT_EQ(scene.refused_body(), 1U);

  const std::byte damaged[64] = {};
  SceneBody broken;
  broken.blob = damaged;
  Simulation other(sheet().bytes(), {}, still(0.01), scene_of({body_on(BodyPath()), broken}));
  EXPECT_NE(other.start_result().blob, core::BlobStatus::kOk);
  EXPECT_THROW(SceneTarget({}, 0), std::invalid_argument);
}

TEST(SceneTarget, LeavingBodyStaysAtBorder) {
  Simulation sim(
      sheet().bytes(), {}, still(0.01),
      scene_of({body_on(BodyPath(isometry({9.0, 0.0, 0.0}), {9.0, 0.0, 0.0}, kNoTurn))}));
  ASSERT_TRUE(sim.arm());
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(sim.step().status.faults, 0U);
  }
}

// Required by emulated boards.
TEST(LinkedBodyTarget, MovesBodyAsInScene) {
  SceneBody body =
      body_on(BodyPath(isometry({0.0, 0.0, 0.0}), {0.002, 0.0, 0.003}, {0.1, 0.0, 0.5}));
  body.until_s = 0.8;
  const auto in_a_scene = run(scene_of({body}), rub());
  const auto linked = run(std::make_unique<LinkedBodyTarget>(std::make_unique<HostTarget>(), body,
                                                             Simulation::arming_ticks({})),
                          rub());
  EXPECT_GT(in_a_scene.contact_ticks, 100U);
  EXPECT_NE(in_a_scene.trace_crc32, run(std::make_unique<HostTarget>(), rub()).trace_crc32);
  EXPECT_EQ(linked.trace_crc32, in_a_scene.trace_crc32);
  EXPECT_EQ(linked.contact_ticks, in_a_scene.contact_ticks);
}

}  // namespace
}  // namespace tactree::test
