// For any sequence of inputs the force is finite, within its limit and its slew, and zero outside
// the active state.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "controller_rig.hpp"
#include "motor_signs.hpp"
#include "tactree/core/configuration/device_presets.hpp"

namespace tactree::test {
namespace {

using core::Command;
using core::State;

struct Counts {
  std::uint64_t broken = 0;
  std::uint64_t active = 0;
  std::uint64_t with_force = 0;
};

void inspect(const core::Output& output, const core::Output& last, const core::Configuration& c,
             Counts& counts) {
  double now = 0.0;
  double step = 0.0;
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    const double effort = static_cast<double>(output.motors.effort(axis));
    const double before = static_cast<double>(last.motors.effort(axis));
    counts.broken += std::isfinite(effort) ? 0U : 1U;
    now += effort * effort;
    step += (effort - before) * (effort - before);
  }
  const bool active = output.status.state == State::kActive;
  const double slew = static_cast<double>(c.limits.slew_N_s) / static_cast<double>(c.rate_hz);
  counts.broken += std::sqrt(now) <= static_cast<double>(c.limits.force_max_N) ? 0U : 1U;
  counts.broken += !active || std::sqrt(step) <= slew ? 0U : 1U;
  counts.broken += active || output.motors.is_zero() ? 0U : 1U;
  counts.broken += output.enable || output.motors.is_zero() ? 0U : 1U;
  counts.broken += output.status.state != State::kFault || !output.enable ? 0U : 1U;
  counts.active += active ? 1U : 0U;
  counts.with_force += output.motors.is_zero() ? 0U : 1U;
}

/// Random walk of the probe in and around the plane.
class WildHand {
 public:
  WildHand(double step_m, double height_m, double width_m)
      : step_m_(step_m), height_m_(height_m), width_m_(width_m) {}
  void move(ControllerRig& session, std::mt19937& random) {
    z_ = std::clamp(z_ + step_m_ * unit_(random), -height_m_, height_m_);
    x_ = std::clamp(x_ + step_m_ * unit_(random), -width_m_, width_m_);
    session.move(x_, 1e-3, z_);
  }

 private:
  double step_m_, height_m_, width_m_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  double z_ = 0.01;
  double x_ = 0.0;
};

constexpr std::uint32_t kPhases = 1000U;
/// The session restarts every kPhases ticks; the dead-man control is held from tick 20 of each
/// phase.
Command command_of(std::uint32_t tick) {
  constexpr Command kBeginAnew[] = {Command::kClearFault, Command::kStop, Command::kArm};
  const std::uint32_t phase = tick % kPhases;
  return phase < 3U ? kBeginAnew[phase] : Command::kNone;
}
bool has_hand(std::uint32_t tick) { return tick % kPhases > 20U; }

TEST(AnyInput, KeepsLimitsUnderRandomInputs) {
  core::Configuration configuration;
  configuration.limits.ramp_s = 0.01F;
  ControllerRig session(configuration);
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(11);
  for (std::uint32_t i = 0; i < 1'000'000U; ++i) {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      session.input.encoders.counts[axis] = static_cast<std::int32_t>(random());
      session.input.encoders.valid[axis] = random() % 16U != 0U;
    }
    session.input.emergency_stop = random() % 8U == 0U;
    session.input.dead_man = random() % 2U == 0U;
    session.input.motors_ok = random() % 8U != 0U;
    session.input.link_alive = random() % 2U == 0U;
    session.input.enable_read_back = random() % 2U == 0U;
    session.enable_follows = random() % 2U == 0U;
    session.input.storage_busy = random() % 4U == 0U;
    session.input.overruns = random() % 64U == 0U ? static_cast<std::uint32_t>(random()) : 0U;
    const core::Output output = session.step(static_cast<Command>(random() % 6U));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
}

// Mostly plausible inputs, which give force: a fast random hand in and around the object.
TEST(AnyInput, KeepsLimitsUnderWildMotion) {
  core::Configuration configuration;
  configuration.limits.ramp_s = 0.01F;
  configuration.contact.stiffness_N_m = 3000.0F;
  configuration.limits.force_max_N = 3.0F;
  configuration.limits.slew_N_s = 500.0F;
  configuration.supervision.speed_max_m_s = 20.0F;
  ControllerRig session(configuration);
  ASSERT_EQ(session.status, core::ConfigurationStatus::kOk);
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(12);
  WildHand hand(2e-3, 8e-3, 0.025);
  for (std::uint32_t i = 0; i < 300'000U; ++i) {
    hand.move(session, random);
    session.input.dead_man = has_hand(i) && random() % 4096U != 0U;
    session.input.emergency_stop = random() % 4096U == 0U;
    const core::Output output = session.step(command_of(i));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
  EXPECT_GT(counts.active, 100'000U);
  EXPECT_GT(counts.with_force, 50'000U);
}

/// A model in its own memory, in which bits flip.
class FailingModel {
 public:
  explicit FailingModel(std::span<const std::byte> sound) : sound_(sound.size() / 4U) {
    std::memcpy(sound_.data(), sound.data(), sound.size());
    words_ = sound_;
    EXPECT_EQ(core::open_blob(std::as_bytes(std::span(words_)), view_), core::BlobStatus::kOk);
    sections_ = {{0U, sizeof(core::BlobHeader)}};
    const core::BlobHeader& h = view_.header();
    for (const core::BlobSection& section :
         {h.nodes, h.directory, h.leaf_bases, h.leaf_offsets, h.points, h.normals, h.neighbours,
          h.materials, h.material_indices}) {
      if (section.bytes >= 4U) {
        sections_.push_back(section);
      }
    }
  }

  [[nodiscard]] const core::BlobView& view() const { return view_; }
  void restore() { words_ = sound_; }
  [[nodiscard]] std::span<std::uint32_t> words_of(const core::BlobSection& section) {
    return std::span(words_).subspan(section.offset / 4U, section.bytes / 4U);
  }
  /// Equal number of flips in each section, independent of its size.
  void flip(std::mt19937& random) {
    const std::span<std::uint32_t> words = words_of(sections_[random() % sections_.size()]);
    words[random() % words.size()] ^= 1U << (random() % 32U);
  }

 private:
  std::vector<std::uint32_t> sound_;
  std::vector<std::uint32_t> words_;  // as long as the blob: a reader beyond it is seen
  std::vector<core::BlobSection> sections_;
  core::BlobView view_;
};

/// The plane with two textured materials.
Shape textured_plane() {
  core::BlobMaterial material{};
  material.stiffness_N_m = 400.0F;
  material.static_friction = 0.3F;
  material.dynamic_friction = 0.2F;
  material.texture_height_m = 5e-5F;
  material.texture_wavelength_m = 2e-3F;
  return two_materials(material, material);
}

// The limits hold for any resulting surface, and nothing is read outside the model, as the
// sanitizers verify. Each phase starts with an intact model; in half of them many bits flip.
void touch_while_bits_flip(const Shape& shape, core::RenderMode mode) {
  core::Configuration configuration;
  configuration.mode = mode;
  configuration.limits.ramp_s = 0.01F;
  configuration.limits.force_max_N = 3.0F;
  configuration.limits.slew_N_s = 500.0F;
  configuration.supervision.speed_max_m_s = 20.0F;
  FailingModel model(shape.bytes());
  ControllerRig session(configuration);
  ASSERT_EQ(session.controller.load_model(model.view()), core::ModelStatus::kOk);
  session.activate();
  core::Output last = session.step();
  Counts counts;
  std::mt19937 random(13);
  WildHand hand(5e-4, 6e-3, 0.015);
  for (std::uint32_t i = 0; i < 300'000U; ++i) {
    hand.move(session, random);
    if (i % kPhases == 0U) {
      model.restore();
    }
    if (i % kPhases > 100U && random() % (i / kPhases % 2U == 0U ? 500U : 5U) == 0U) {
      model.flip(random);
    }
    session.input.dead_man = has_hand(i);
    const core::Output output = session.step(command_of(i));
    inspect(output, last, configuration, counts);
    last = output;
  }
  EXPECT_EQ(counts.broken, 0U);
  EXPECT_GT(counts.with_force, 10'000U);
}

TEST(AnyInput, KeepsLimitsUnderModelCorruption) {
  touch_while_bits_flip(shared_plane(), core::RenderMode::kSurface);
}

TEST(AnyInput, KeepsLimitsUnderMaterialCorruption) {
  touch_while_bits_flip(textured_plane(), core::RenderMode::kSurface);
}

// An index to a missing element is a fault, not empty space.
TEST(AnyInput, FaultsOnIndexOutsideModel) {
  struct Damage {
    const char* name;
    core::BlobSection core::BlobHeader::*section;
    void (*apply)(std::uint32_t& word, const core::BlobHeader& sound);
  };
  const Damage damages[] = {
      {"no node", &core::BlobHeader::directory,
       [](std::uint32_t& word, const core::BlobHeader& h) { word = h.node_count; }},
      {"no leaf", &core::BlobHeader::nodes,
       [](std::uint32_t& word, const core::BlobHeader&) { word |= 0xFFFFFFU; }},
      {"no point", &core::BlobHeader::leaf_bases,
       [](std::uint32_t& word, const core::BlobHeader& h) { word = h.point_count; }},
      {"its end before its begin", &core::BlobHeader::leaf_offsets,
       [](std::uint32_t& word, const core::BlobHeader&) { word = 0xFFFFU; }},
  };
  for (const Damage& damage : damages) {
    SCOPED_TRACE(damage.name);
    FailingModel model(shared_plane().bytes());
    const core::BlobHeader header = model.view().header();
    ASSERT_LT(header.node_count, header.leaf_count);  // else a node's number would name no leaf
    ControllerRig session;
    ASSERT_EQ(session.controller.load_model(model.view()), core::ModelStatus::kOk);
    session.activate();
    for (std::uint32_t& word : model.words_of(header.*damage.section)) {
      damage.apply(word, header);
    }
    EXPECT_EQ(session.press(2e-3).status.faults, core::fault_bit(core::Fault::kModelIncomplete));
  }
}

// Also a support with more points than declared, by which the bound of a tick counts.
TEST(AnyInput, FaultsOnCrowdedSupport) {
  constexpr std::size_t kAt = offsetof(core::BlobHeader, points_per_support_max) / 4U;
  FailingModel model(shared_plane().bytes());
  for (const std::uint32_t declared : {1U, model.view().header().points_per_support_max}) {
    model.words_of({0, sizeof(core::BlobHeader)})[kAt] = declared;
    ControllerRig session;
    ASSERT_EQ(session.controller.load_model(model.view()), core::ModelStatus::kOk);
    session.activate();
    EXPECT_EQ(session.press(2e-3).status.faults,
              declared == 1U ? core::fault_bit(core::Fault::kModelIncomplete) : 0U);
  }
}

TEST(AnyInput, FaultsOnNaNMaterial) {
  const Shape shape = textured_plane();
  FailingModel model(shape.bytes());
  ControllerRig session;
  ASSERT_EQ(session.controller.load_model(model.view()), core::ModelStatus::kOk);
  session.activate();
  ASSERT_EQ(session.press(1e-3).status.faults, 0U);
  for (std::uint32_t& word : model.words_of(model.view().header().materials)) {
    word = 0x7FC00000U;
  }
  const core::Output output = session.step();
  EXPECT_EQ(output.status.faults, core::fault_bit(core::Fault::kNotFinite));
  EXPECT_TRUE(output.motors.is_zero());
}

/// Moves the joints at random about a position in the middle of their ranges.
class WildJoints {
 public:
  explicit WildJoints(const core::DeviceModel& device) : device_(device) {}
  void move(core::EncoderReading& encoders, std::mt19937& random) {
    for (std::uint32_t axis = 0; axis < core::axes_of(device_.kind); ++axis) {
      const float reach = 0.02F * (device_.joint_max[axis] - device_.joint_min[axis]);
      offset_[axis] = std::clamp(offset_[axis] + 0.02F * reach * unit_(random), -reach, reach);
      const float counts = core::counts_per_unit(device_, axis) * offset_[axis];
      encoders.counts[axis] = static_cast<std::int32_t>(counts);
    }
  }

 private:
  core::DeviceModel device_;
  float offset_[core::kAxes] = {0.0F, 0.0F, 0.0F};
  std::uniform_real_distribution<float> unit_{-1.0F, 1.0F};
};

/// Largest force of the motors at the probe, and ticks in contact with force.
struct Largest {
  double force_N = 0.0;
  std::uint32_t in_contact = 0;
};

/// Random joints, contacts, arming and added forces on one device. `any_signs`: every motor may
/// turn the wrong way.
Largest largest_of_session(const core::DevicePreset& preset, core::Configuration configuration,
                           bool any_signs) {
  configuration.limits.ramp_s = 0.01F;
  configuration.model_origin_m = core::locate(preset.model, {0, 0, 0}).probe;
  configuration.supervision.stuck_s = 1.0F;
  ControllerRig session(configuration);
  EXPECT_EQ(session.status, core::ConfigurationStatus::kOk);
  WildJoints joints(session.controller.configuration().device);
  std::mt19937 random(1);
  Largest largest;
  for (std::uint32_t i = 0; i < 10'000U; ++i) {
    joints.move(session.input.encoders, random);
    session.input.dead_man = has_hand(i);
    session.input.added_force = {{0.3F, -0.3F, 0.3F}, 50U};
    const core::Output output = session.step(command_of(i));
    const core::DevicePose pose =
        core::locate(session.controller.configuration().device, session.input.encoders.counts);
    const double force_N =
        any_signs ? largest_probe_force(pose, output.motors) : probe_force(pose, output.motors, 0U);
    largest.force_N = std::max(largest.force_N, force_N);
    largest.in_contact += output.status.rendering.in_contact && !output.motors.is_zero() ? 1U : 0U;
  }
  return largest;
}

void expect_within(const Largest& largest, float force_max_N) {
  EXPECT_LE(largest.force_N, 1.00001 * static_cast<double>(force_max_N));
  EXPECT_GE(largest.force_N, 0.8 * static_cast<double>(force_max_N));
  EXPECT_GT(largest.in_contact, 500U);
}

// The first power-on of a new arm: an added force on top, every motor possibly reversed.
TEST(AnyInput, KeepsFirstForceWithAnySigns) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    SCOPED_TRACE(preset.name);
    core::Configuration configuration;
    core::use_device(preset, configuration);
    expect_within(largest_of_session(preset, core::first_force(configuration), true),
                  core::kFirstForce_N);
  }
}

// An arm whose signs are proven: gravity compensation and an added force on top.
TEST(AnyInput, KeepsSmallLimitWithGravityAndAddedForce) {
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    SCOPED_TRACE(preset.name);
    core::Configuration configuration;
    core::use_device(preset, configuration);
    core::limit_force(configuration, 0.5F);
    ASSERT_TRUE(configuration.compensate_gravity);
    expect_within(largest_of_session(preset, configuration, false), 0.5F);
  }
}

TEST(AnyInput, KeepsLimitsUnderPaperCorruption) {
  touch_while_bits_flip(shared_plane().paper_twin(), core::RenderMode::kPaper);
}

}  // namespace
}  // namespace tactree::test
