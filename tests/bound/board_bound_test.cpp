// No tick of an emulated board executes more instructions than the bound of its image, and none
// executes code that was not analysed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "boards_for_test.hpp"
#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/wcet/bound.hpp"
#include "test_models.hpp"
#include "worst_seeking.hpp"

namespace tactree::test {
namespace {

// Boards with images that can be analysed and cores that the emulator models.
const char* const kProven[] = {"mps2-an386", "netduinoplus2", "mps2-an500", "mps2-an505"};

std::vector<const emulation::BoardDescription*> proven_boards() {
  std::vector<const emulation::BoardDescription*> boards;
  for (const char* name : kProven) {
    boards.push_back(emulation::find_board(name));
  }
  return boards;
}

wcet::Bound bound_of(const emulation::BoardDescription& board, const core::BlobView& view,
                     core::RenderMode mode, float rate_hz = core::Configuration{}.rate_hz,
                     core::DeviceKind device = core::DeviceKind::kCartesian,
                     const std::filesystem::path& sources = source_folder()) {
  wcet::BoundOptions options;
  options.image = bare_firmware(board);
  options.sources = {sources};
  options.entries = wcet::tick_entries();
  options.parameters = wcet::parameters_of(view.header(), mode, 1, device);
  options.work_tier = core::work_tier_of(rate_hz);
  return wcet::worst_case(options);
}

/// True if the whole range is in analysed blocks or in functions that end the emulation.
bool analysed(const wcet::Bound& bound, emulation::CodeRange range) {
  std::map<std::uint32_t, std::uint32_t> known;
  for (const auto* blocks : {&bound.blocks, &bound.endings}) {
    for (const wcet::BlockOnPath& block : *blocks) {
      known[block.address] = block.end;
    }
  }
  std::uint32_t at = range.begin;
  while (at < range.end) {
    const auto after = known.upper_bound(at);
    if (after == known.begin() || std::prev(after)->second <= at) {
      return false;
    }
    at = std::prev(after)->second;
  }
  return true;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// True if the range is in the program's flash or in the blob.
bool touches_flash(const emulation::BoardDescription& board, const emulation::DataRange& range) {
  constexpr std::uint32_t kRam = 0x20000000U;
  const std::uint32_t blob_end = board.blob_address + board.blob_bytes_max;
  return range.lowest < kRam || (range.highest >= board.blob_address && range.lowest < blob_end);
}

class Proof : public OnBoard {
 protected:
  void expect_all_analysed(const wcet::Bound& bound,
                           const std::vector<emulation::CodeRange>& code) {
    EXPECT_FALSE(code.empty());
    for (const emulation::CodeRange& range : code) {
      EXPECT_TRUE(analysed(bound, range)) << std::hex << "executed, but not analysed: within "
                                          << range.begin << " .. " << range.end;
    }
  }
  // Instructions annotated as accessing RAM access neither the blob nor the program.
  void expect_in_ram(const wcet::Bound& bound, const std::vector<emulation::DataRange>& data) {
    std::size_t seen = 0;
    for (const emulation::DataRange& range : data) {
      if (bound.in_ram.contains(range.instruction)) {
        ++seen;
        EXPECT_FALSE(touches_flash(board(), range))
            << std::hex << "annotated as accessing RAM, but at " << range.instruction
            << " accesses " << range.lowest << " .. " << range.highest;
      }
    }
    EXPECT_GT(seen, 0U);
  }
};
INSTANTIATE_TEST_SUITE_P(Boards, Proof, testing::ValuesIn(proven_boards()), name_of_board);

TEST_P(Proof, AppliesEverySourceLimit) {
  const TestBlob blob(expensive_model(ExpensiveModel::kEdge));
  EXPECT_EQ(bound_of(board(), blob.view(), core::RenderMode::kSurface).unused_facts,
            std::vector<std::string>{});
}

// Range of the probe around the origin: some supports of the model.
constexpr float kSize_m = 2e-3F;
constexpr int kRuns = 12;

// Cores on which the search must reach kTightness of the bound.
bool is_tight(const emulation::BoardDescription& board) {
  return std::string(board.toolchain) == "cortex-m4f";
}
constexpr double kTightness = 0.75;

TEST_P(Proof, FindsNoTickAboveBound) {
  double reached = 0.0;
  for (const float rate_hz : {1000.0F, 2000.0F, 4000.0F}) {
    for (const ExpensiveModel kind :
         {ExpensiveModel::kEdge, ExpensiveModel::kRandomNormals, ExpensiveModel::kOblique}) {
      const TestBlob blob(expensive_model(kind));
      const wcet::Bound bound = bound_of(board(), blob.view(), core::RenderMode::kSurface, rate_hz);
      emulation::EmulationOptions noting = options();
      noting.note_code = true;
      const Found found = seek_worst(board(), noting, blob.written().bytes, kSize_m, kRuns,
                                     core::RenderMode::kSurface, rate_hz, 1);
      EXPECT_LE(found.instructions, bound.instructions);
      expect_all_analysed(bound, found.code);
      expect_in_ram(bound, found.data);
      const double share =
          static_cast<double>(found.instructions) / static_cast<double>(bound.instructions);
      reached = std::max(reached, share);
      std::printf("%s, %.0f Hz: worst tick found %llu instructions, bound %llu, %.1f %%\n",
                  board().name, static_cast<double>(rate_hz),
                  static_cast<unsigned long long>(found.instructions),
                  static_cast<unsigned long long>(bound.instructions), 100.0 * share);
    }
  }
  if (is_tight(board())) {
    EXPECT_GE(reached, kTightness);
  }
}

TEST_P(Proof, HoldsInPaperMode) {
  for (const core::Profile profile : {core::Profile::kSurface, core::Profile::kPaper}) {
    const TestBlob blob(random_cloud(2000, 0.01, 0.2e-3, profile, 3));
    const wcet::Bound bound = bound_of(board(), blob.view(), core::RenderMode::kPaper);
    emulation::EmulationOptions noting = options();
    noting.note_code = true;
    const Found found = seek_worst(board(), noting, blob.written().bytes, 6e-3F, kRuns / 2,
                                   core::RenderMode::kPaper, 1000.0F, 1);
    EXPECT_LE(found.instructions, bound.instructions);
    expect_all_analysed(bound, found.code);
    expect_in_ram(bound, found.data);
  }
}

// Scripts of the simulation with every device: armed, in contact, with device faults.
TEST_P(Proof, HoldsForEveryDevice) {
  const core::BlobView& view = touched_shape().view();
  const wcet::Bound bound =
      bound_of(board(), view, core::RenderMode::kSurface, 1000.0F, core::DeviceKind::kDelta);
  for (const core::DevicePreset& device : core::kDevicePresets) {
    simulation::Setup setup;
    simulation::use_device(device, setup);
    emulation::EmulationOptions noting = options();
    noting.note_code = true;
    auto target =
        std::make_unique<emulation::EmulatedTarget>(board(), touched_shape().bytes(), noting);
    const emulation::EmulatedTarget& emulated = *target;
    simulation::Simulation sim(touched_shape().bytes(), setup,
                               simulation::make_script("rub", view, 1.0), std::move(target));
    (void)sim.arm();
    for (int i = 0; i < 300; ++i) {
      (void)sim.step();
    }
    sim.finish();
    const emulation::InstructionCounts& counts = emulated.instruction_counts().value();
    EXPECT_GT(counts.ticks, 300U) << device.name;
    EXPECT_LE(counts.max, bound.instructions) << device.name;
    expect_all_analysed(bound, counts.code);
    expect_in_ram(bound, counts.data);
  }
}

wcet::BoundOptions in_cycles(const emulation::BoardDescription& board) {
  wcet::BoundOptions options;
  options.image = bare_firmware(board);
  options.sources = {source_folder()};
  options.entries = wcet::tick_entries();
  options.timing = wcet::find_timing(board.name);
  return options;
}

core::ModelLimits random_limits(std::mt19937& random) {
  const core::ModelLimits most = wcet::largest_model_limits();
  const auto any = [&](std::uint32_t largest) {
    return std::uniform_int_distribution<std::uint32_t>(0, largest)(random);
  };
  const std::uint32_t in_ball = any(most.points_per_ball_max);
  return {in_ball,
          any(in_ball),
          any(most.points_per_leaf_max),
          any(most.depth),
          any(most.levels_below),
          any(most.blended_points),
          any(most.blended_materials)};
}

TEST_P(Proof, FormulaNeverUndercutsBound) {
  wcet::BoundOptions options = in_cycles(board());
  const core::TickCosts costs = wcet::tick_costs(options);
  std::mt19937 random(5);
  core::TickLoad load;
  for (const auto kind :
       {core::TickKind::kSurface, core::TickKind::kMixed, core::TickKind::kPaper}) {
    for (load.bodies = 1; load.bodies <= core::kMaxReachableBodies; ++load.bodies) {
      for (load.work_tier = 0; load.work_tier < core::kWorkTiers; ++load.work_tier) {
        load.kind = kind;
        load.limits = random_limits(random);
        load.delta = !load.delta;
        options.work_tier = load.work_tier;
        options.parameters = wcet::parameters_of(load.limits, kind, load.bodies, load.delta);
        EXPECT_GE(core::cycles_of(costs, load), wcet::worst_case(options).cycles)
            << "kind " << static_cast<int>(kind) << ", work_tier " << load.work_tier << ", "
            << load.bodies << " bodies";
      }
    }
  }
}

// The limits of the Stanford bunny, 10 cm long with a point every 0.5 mm.
TEST_P(Proof, FormulaStaysWithinThreePercent) {
  core::TickLoad load;
  load.limits = {46, 35, 51, 6, 3, 0, 0};
  load.bodies = 1;
  wcet::BoundOptions options = in_cycles(board());
  const core::TickCosts costs = wcet::tick_costs(options);
  for (load.work_tier = 0; load.work_tier < core::kWorkTiers; ++load.work_tier) {
    options.work_tier = load.work_tier;
    options.parameters = wcet::parameters_of(load.limits, core::TickKind::kSurface, 1, load.delta);
    const auto exact = static_cast<double>(wcet::worst_case(options).cycles);
    const auto formula = static_cast<double>(core::cycles_of(costs, load));
    std::printf("%s: work_tier %u: formula %.0f, bound %.0f\n", board().name, load.work_tier,
                formula, exact);
    EXPECT_GE(formula, exact);
    EXPECT_LE(formula, 1.03 * exact) << "work_tier " << load.work_tier;
  }
}

// A gather covers more than the support of a fit: the other points cost less.
TEST_P(Proof, CountsFullPriceInSupportOnly) {
  wcet::BoundOptions options = in_cycles(board());
  options.work_tier = core::work_tier_of(1000.0F);  // where fits are the most expensive part
  const auto cycles_with = [&](std::uint32_t in_ball, std::uint32_t in_support) {
    options.parameters = wcet::parameters_of({in_ball, in_support, 51, 6, 3, 0, 0},
                                             core::TickKind::kSurface, 1, false);
    return wcet::worst_case(options).cycles;
  };
  const auto all = cycles_with(46, 46);
  EXPECT_LT(cycles_with(46, 34), all - 12 * 60);
  EXPECT_LT(cycles_with(34, 34), cycles_with(46, 34));
}

/// Answer of a board, whose image has its costs, to a start at this rate.
hal::StartResult start_at(const emulation::BoardDescription& board,
                          const std::filesystem::path& image, double rate_hz) {
  simulation::Setup setup;
  setup.controller.rate_hz = static_cast<float>(rate_hz);
  setup.controller.velocity_cutoff_hz = 0.2F * setup.controller.rate_hz;
  setup.controller.contact.stiffness_N_m = 10.0F;
  setup.controller.limits.slew_N_s = setup.controller.rate_hz;
  for (float& slew : setup.controller.motors.effort_slew_s) {
    slew = setup.controller.rate_hz;
  }
  emulation::EmulationOptions options;
  options.image = image;
  simulation::Simulation sim(
      touched_shape().bytes(), setup, simulation::make_script("hover", touched_shape().view(), 1.0),
      std::make_unique<emulation::EmulatedTarget>(board, touched_shape().bytes(), options));
  EXPECT_EQ(sim.arm(), sim.start_result().ok());
  sim.finish();
  return sim.start_result();
}

TEST_P(Proof, BoardRefusesExcessiveRate) {
  const std::filesystem::path image =
      std::filesystem::path(testing::TempDir()) / (std::string(board().name) + "_costs.elf");
  std::filesystem::copy_file(bare_firmware(board()), image,
                             std::filesystem::copy_options::overwrite_existing);
  const wcet::BoundOptions options = in_cycles(board());
  wcet::embed(image, wcet::tick_costs(options));
  EXPECT_EQ(wcet::embedded(image).known, core::kTickCostsKnown);
  ASSERT_EQ(
      std::system(
          (source_folder() / "scripts/seal-image").string().append(" " + image.string()).c_str()),
      0);

  core::TickLoad load;
  load.add(touched_shape().view().header(), {});
  wcet::WorkTierCycles cycles{};
  for (load.work_tier = 0; load.work_tier < core::kWorkTiers; ++load.work_tier) {
    cycles[load.work_tier] = static_cast<double>(core::cycles_of(wcet::embedded(image), load));
  }
  const double highest = wcet::highest_rate(options.timing->clock_hz, cycles);
  std::printf("%s: highest rate admitted %.0f Hz\n", board().name, highest);
  const hal::StartResult refused = start_at(board(), image, 1.01 * std::max(highest, 100.0));
  EXPECT_EQ(refused.model, core::ModelStatus::kTooSlow) << core::describe(refused.configuration);
  if (highest > 101.0) {  // the lowest rate of all
    EXPECT_TRUE(start_at(board(), image, 0.99 * highest).ok());
  }
  std::filesystem::remove(image);
}

// Tests the search itself: it exceeds the bound of an annotation that is too small.
TEST_P(Proof, SearchExceedsUndersizedBound) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("too_small_" + std::string(board().name));
  std::filesystem::create_directories(folder);
  for (const char* part : {"core", "hal", "firmware"}) {
    std::filesystem::copy(source_folder() / part, folder / part,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
  }
  const std::filesystem::path file = folder / "core/src/contact/passes.cpp";
  std::string text = read_text(file);
  for (const std::string correct : {"points_per_ball_max", "points_per_support_max"}) {
    const std::string too_small = correct + " / 3";
    for (std::size_t at = 0; (at = text.find(correct, at)) != std::string::npos;
         at += too_small.size()) {
      text.replace(at, correct.size(), too_small);
    }
  }
  std::ofstream(file) << text;

  const TestBlob blob(expensive_model(ExpensiveModel::kEdge));
  constexpr float kRate_hz = 4000.0F;  // at which the bound is tightest
  const wcet::Bound bound = bound_of(board(), blob.view(), core::RenderMode::kSurface, kRate_hz,
                                     core::DeviceKind::kCartesian, folder);
  const Found found = seek_worst(board(), options(), blob.written().bytes, kSize_m, kRuns,
                                 core::RenderMode::kSurface, kRate_hz, 1);
  EXPECT_GT(found.instructions, bound.instructions);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tactree::test
