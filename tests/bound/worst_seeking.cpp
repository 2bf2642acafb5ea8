#include "worst_seeking.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tactree/core/contact/surface.hpp"

namespace tactree::test {
namespace {

constexpr float kCountsPerMetre = 1e7F;
constexpr std::size_t kEpisode = 24;  // ticks
constexpr std::size_t kEpisodes = 30;
constexpr float kPatch_m = 0.05e-3F;  // of the expensive models
constexpr float kDrift_m = 4e-6F;     // per tick; below their slack

double as_double(float v) { return static_cast<double>(v); }

/// Every part that costs instructions is enabled; no limit on the jumps of the probe.
core::Configuration free_probe(core::RenderMode mode, float rate_hz) {
  core::Configuration c;
  c.mode = mode;
  c.rate_hz = rate_hz;
  c.velocity_cutoff_hz = 0.2F * rate_hz;
  c.supervision.speed_max_m_s = 100.0F;
  c.supervision.dead_man_required = false;
  c.limits.ramp_s = 0.002F;
  c.device.homing = core::HomingMethod::kAbsolute;
  for (std::uint32_t i = 0; i < core::kAxes; ++i) {
    c.device.counts_per_m[i] = kCountsPerMetre;
  }
  return c;
}

core::Status step(emulation::EmulatedTarget& target, hal::sim::SimBoard& board, core::Vec3 at) {
  board.sample({std::round(as_double(at.x * kCountsPerMetre)),
                std::round(as_double(at.y * kCountsPerMetre)),
                std::round(as_double(at.z * kCountsPerMetre))});
  return target.tick(board);
}

/// Arms if the position is free; ticks in contact cost about the same.
void arm(emulation::EmulatedTarget& target, hal::sim::SimBoard& board, core::Vec3 at) {
  for (int i = 0; i < 12; ++i) {
    board.link().post(i == 2 || i == 9 ? core::Command::kArm : core::Command::kNone);
    (void)step(target, board, at);
  }
}

class Climber {
 public:
  Climber(float size_m, std::uint32_t seed) : size_m_(size_m), random_(seed) {}

  ProbePath random_episode() {
    ProbePath path;
    for (std::size_t i = 0; i < kEpisode; ++i) {
      path.push_back(place(size_m_));
    }
    return path;
  }

  /// A straight path in steps so small that candidates are gathered ahead.
  ProbePath drifting_episode() {
    ProbePath path = {place(kPatch_m)};
    const core::Vec3 step = place(kDrift_m);
    for (std::size_t i = 1; i < kEpisode; ++i) {
      path.push_back(path.back() + step);
    }
    return path;
  }

  /// Moves some positions, most by a small step.
  ProbePath changed(const ProbePath& path) {
    ProbePath result = path;
    const float scale = size_m_ * std::pow(10.0F, -3.0F * uniform());
    for (core::Vec3& at : result) {
      const float choice = uniform();
      if (choice < 0.1F) {
        at = place(size_m_);
      } else if (choice < 0.4F) {
        at += place(scale);
      }
    }
    return result;
  }

  float uniform() { return std::uniform_real_distribution<float>(0.0F, 1.0F)(random_); }

 private:
  core::Vec3 place(float size) {
    const auto one = [&] { return size * (2.0F * uniform() - 1.0F); };
    const float x = one();
    const float y = one();
    return {x, y, one()};
  }

  float size_m_;
  std::mt19937 random_;
};

}  // namespace

builder::Model expensive_model(ExpensiveModel kind) {
  constexpr double kSupport = 0.5e-3;
  constexpr double kPatch = static_cast<double>(kPatch_m);
  builder::Model model;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (std::uint32_t i = 0; i < core::kMaxCandidates; ++i) {
    const double u = place(random);
    const double v = std::abs(place(random));
    const bool top = i % 2 == 0;
    if (kind == ExpensiveModel::kEdge) {
      // In most of eight leaves rather than at their common corner.
      model.positions.emplace_back(kPatch * (top ? 0.4 - v : 0.4), kPatch * u,
                                   kPatch * (top ? 0.4 : 0.4 - v));
      model.normals.emplace_back(top ? 0.0F : 1.0F, 0.0F, top ? 1.0F : 0.0F);
    } else if (kind == ExpensiveModel::kOblique) {
      constexpr double kTilt = 1.2;  // rad
      const double turn = 1.2 * place(random);
      model.positions.emplace_back(kPatch * u, kPatch * place(random), kPatch * place(random));
      const Eigen::Vector3d oblique(std::sin(kTilt) * std::cos(turn),
                                    std::sin(kTilt) * std::sin(turn), std::cos(kTilt));
      model.normals.push_back(
          (i % 16 == 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : oblique).cast<float>());
    } else {
      model.positions.emplace_back(kPatch * u, kPatch * place(random), kPatch * place(random));
      const Eigen::Vector3d normal(place(random), place(random), place(random));
      model.normals.push_back((normal + Eigen::Vector3d(1e-3, 0, 0)).normalized().cast<float>());
    }
  }
  // Distant points make the tree deep.
  for (const double side : {-1.0, 1.0}) {
    model.positions.emplace_back(side * Eigen::Vector3d::Constant(0.3));
    model.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  model.spacing_m = 0.4 * kSupport;
  model.support_radius_m = kSupport;
  model.reach_m = 1.02 * kSupport;
  return model;
}

emulation::InstructionCounts follow(const emulation::BoardDescription& board,
                                    emulation::EmulationOptions options,
                                    std::span<const std::byte> blob, const ProbePath& path,
                                    core::RenderMode mode, float rate_hz) {
  hal::sim::BoardParameters parameters;
  parameters.encoders.counts_per_m = 1.0;
  hal::sim::SimBoard plant(parameters, blob);
  emulation::EmulatedTarget target(board, blob, options);
  EXPECT_TRUE(target.start(plant, free_probe(mode, rate_hz)).ok());
  arm(target, plant, path.at(0));
  for (const core::Vec3& at : path) {
    plant.link().post(core::Command::kNone);
    (void)step(target, plant, at);
  }
  target.finish();
  return target.instruction_counts().value();
}

Found seek_worst(const emulation::BoardDescription& board,
                 const emulation::EmulationOptions& options, std::span<const std::byte> blob,
                 float size_m, int runs, core::RenderMode mode, float rate_hz, std::uint32_t seed) {
  Climber climber(size_m, seed);
  emulation::EmulationOptions counted = options;
  counted.uncounted_ticks = 12;
  counted.instruction_shift = 0;  // time for the longest tick
  Found found;
  for (int run = 0; run < runs; ++run) {
    ProbePath path;
    for (std::size_t i = 0; i < kEpisodes; ++i) {
      const bool fresh = found.path.empty() || climber.uniform() < 0.2F;
      const bool drifts = fresh && climber.uniform() < 0.5F;
      const ProbePath episode = drifts  ? climber.drifting_episode()
                                : fresh ? climber.random_episode()
                                        : climber.changed(found.path);
      path.insert(path.end(), episode.begin(), episode.end());
    }
    const emulation::InstructionCounts counts = follow(board, counted, blob, path, mode, rate_hz);
    found.code.insert(found.code.end(), counts.code.begin(), counts.code.end());
    found.data.insert(found.data.end(), counts.data.begin(), counts.data.end());
    if (counts.max > found.instructions) {
      found.instructions = counts.max;
      const auto worst = static_cast<std::size_t>(counts.worst_tick);
      const std::size_t begin = worst + 1 < kEpisode ? 0 : worst + 1 - kEpisode;
      found.path.assign(path.begin() + static_cast<std::ptrdiff_t>(begin),
                        path.begin() + static_cast<std::ptrdiff_t>(worst + 1));
      found.path.resize(kEpisode, found.path.back());
    }
  }
  return found;
}

}  // namespace tactree::test
