// The proof holds: no tick of an emulated board takes more instructions than the bound of its
// image, and none executes code that was not analysed.

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
#include "tactree/bound/bound.hpp"
#include "tactree/core/device_presets.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "test_models.hpp"
#include "worst_seeking.hpp"

namespace tactree::test {
namespace {

// Of the images, those that can be analysed and whose cores the emulator models.
const char* const kProven[] = {"mps2-an386", "netduinoplus2", "mps2-an500", "mps2-an505"};

std::vector<const emulation::BoardDescription*> proven_boards() {
  std::vector<const emulation::BoardDescription*> boards;
  for (const char* name : kProven) {
    boards.push_back(emulation::find_board(name));
  }
  return boards;
}

bound::Bound bound_of(const emulation::BoardDescription& board, const core::BlobView& view,
                      core::RenderMode mode, float rate_hz = core::Configuration{}.rate_hz,
                      core::DeviceKind device = core::DeviceKind::kCartesian,
                      const std::filesystem::path& sources = TACTREE_SOURCES) {
  bound::BoundOptions options;
  options.image = bare_firmware(board);
  options.sources = sources;
  options.entries = bound::tick_entries();
  options.parameters = bound::parameters_of(view.header(), mode, 1, device);
  options.pace = core::pace_of(rate_hz);
  return bound::worst_case(options);
}

/// Is all of the range in blocks that were analysed, or in what ends the emulation after the ticks?
bool analysed(const bound::Bound& bound, emulation::CodeRange range) {
  std::map<std::uint32_t, std::uint32_t> known;
  for (const auto* blocks : {&bound.blocks, &bound.endings}) {
    for (const bound::BlockOnPath& block : *blocks) {
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

/// Flash: the program's, or where the blob is.
bool touches_flash(const emulation::BoardDescription& board, const emulation::DataRange& range) {
  constexpr std::uint32_t kRam = 0x20000000U;
  const std::uint32_t blob_end = board.blob_address + board.blob_bytes_max;
  return range.lowest < kRam || (range.highest >= board.blob_address && range.lowest < blob_end);
}

class Proof : public OnBoard {
 protected:
  void expect_all_analysed(const bound::Bound& bound,
                           const std::vector<emulation::CodeRange>& code) {
    EXPECT_FALSE(code.empty());
    for (const emulation::CodeRange& range : code) {
      EXPECT_TRUE(analysed(bound, range)) << std::hex << "executed, but not analysed: within "
                                          << range.begin << " .. " << range.end;
    }
  }
  // What the sources call RAM is none of the blob or the program.
  void expect_in_ram(const bound::Bound& bound, const std::vector<emulation::DataRange>& data) {
    std::size_t seen = 0;
    for (const emulation::DataRange& range : data) {
      if (bound.in_ram.contains(range.instruction)) {
        ++seen;
        EXPECT_FALSE(touches_flash(board(), range))
            << std::hex << "said to use RAM, but at " << range.instruction << " uses "
            << range.lowest << " .. " << range.highest;
      }
    }
    EXPECT_GT(seen, 0U);
  }
};
INSTANTIATE_TEST_SUITE_P(Boards, Proof, testing::ValuesIn(proven_boards()), name_of_board);

TEST_P(Proof, EveryFactOfTheSourcesHoldsOnToCode) {
  const TestBlob blob(nasty_model(Nastiness::kEdge));
  EXPECT_EQ(bound_of(board(), blob.view(), core::RenderMode::kSurface).unused_facts,
            std::vector<std::string>{});
}

// How far from the origin it makes sense to look for the worst tick: some supports of the model.
constexpr float kSize_m = 2e-3F;
constexpr int kRuns = 12;

// Seeking on these cores reaches so much of the bound: it is no idle one.
bool is_tight(const emulation::BoardDescription& board) {
  return std::string(board.toolchain) == "cortex-m4f";
}
constexpr double kTightness = 0.8;

TEST_P(Proof, SeekingFindsNoTickBeyondTheBound) {
  double reached = 0.0;
  for (const float rate_hz : {1000.0F, 2000.0F, 4000.0F}) {
    for (const Nastiness kind : {Nastiness::kEdge, Nastiness::kRandomNormals, Nastiness::kAskew}) {
      const TestBlob blob(nasty_model(kind));
      const bound::Bound bound =
          bound_of(board(), blob.view(), core::RenderMode::kSurface, rate_hz);
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
    const bound::Bound bound = bound_of(board(), blob.view(), core::RenderMode::kPaper);
    emulation::EmulationOptions noting = options();
    noting.note_code = true;
    const Found found = seek_worst(board(), noting, blob.written().bytes, 6e-3F, kRuns / 2,
                                   core::RenderMode::kPaper, 1000.0F, 1);
    EXPECT_LE(found.instructions, bound.instructions);
    expect_all_analysed(bound, found.code);
    expect_in_ram(bound, found.data);
  }
}

// Scripts as people run them, with every device: armed, in contact, with faults of the device.
TEST_P(Proof, HoldsForEveryDevice) {
  const core::BlobView& view = touched_shape().view();
  const bound::Bound bound =
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

bound::BoundOptions in_cycles(const emulation::BoardDescription& board) {
  bound::BoundOptions options;
  options.image = bare_firmware(board);
  options.sources = TACTREE_SOURCES;
  options.entries = bound::tick_entries();
  options.timing = bound::find_timing(board.name);
  return options;
}

core::TickFigures some_figures(std::mt19937& random) {
  const core::TickFigures most = bound::largest_figures();
  const auto any = [&](std::uint32_t largest) {
    return std::uniform_int_distribution<std::uint32_t>(0, largest)(random);
  };
  return {
      any(most.points_per_ball_max), any(most.points_per_leaf_max), any(most.depth),
      any(most.levels_below),        any(most.blended_points),      any(most.blended_materials)};
}

TEST_P(Proof, TheFormulaIsNeverLessThanTheBound) {
  bound::BoundOptions options = in_cycles(board());
  const core::TickCosts costs = bound::tick_costs(options);
  std::mt19937 random(5);
  core::TickLoad load;
  for (const auto kind :
       {core::TickKind::kSurface, core::TickKind::kMixed, core::TickKind::kPaper}) {
    for (load.bodies = 1; load.bodies <= core::kMaxReachableBodies; ++load.bodies) {
      for (load.pace = 0; load.pace < core::kPaces; ++load.pace) {
        load.kind = kind;
        load.figures = some_figures(random);
        load.delta = !load.delta;
        options.pace = load.pace;
        options.parameters = bound::parameters_of(load.figures, kind, load.bodies, load.delta);
        EXPECT_GE(core::cycles_of(costs, load), bound::worst_case(options).cycles)
            << "kind " << static_cast<int>(kind) << ", pace " << load.pace << ", " << load.bodies
            << " bodies";
      }
    }
  }
}

// The figures of the Stanford bunny, 10 cm long with a point every 0.5 mm.
TEST_P(Proof, TheFormulaIsCloseForAModelOfAScan) {
  core::TickLoad load;
  load.figures = {46, 51, 6, 3, 0, 0};
  load.bodies = 1;
  bound::BoundOptions options = in_cycles(board());
  const core::TickCosts costs = bound::tick_costs(options);
  for (load.pace = 0; load.pace < core::kPaces; ++load.pace) {
    options.pace = load.pace;
    options.parameters =
        bound::parameters_of(load.figures, core::TickKind::kSurface, 1, load.delta);
    const auto exact = static_cast<double>(bound::worst_case(options).cycles);
    const auto formula = static_cast<double>(core::cycles_of(costs, load));
    std::printf("%s: pace %u: formula %.0f, bound %.0f\n", board().name, load.pace, formula, exact);
    EXPECT_GE(formula, exact);
    EXPECT_LE(formula, 1.02 * exact) << "pace " << load.pace;
  }
}

/// What a board says that knows its costs.
hal::StartResult start_at(const emulation::BoardDescription& board,
                          const std::filesystem::path& image, double rate_hz) {
  simulation::Setup setup;
  setup.controller.rate_hz = static_cast<float>(rate_hz);
  setup.controller.velocity_cutoff_hz = 0.2F * setup.controller.rate_hz;
  setup.controller.stiffness_N_m = 10.0F;
  setup.controller.slew_N_s = setup.controller.rate_hz;
  for (float& slew : setup.controller.effort_slew_s) {
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

TEST_P(Proof, ABoardThatKnowsItsCostsRefusesARateItCannotKeep) {
  const std::filesystem::path image =
      std::filesystem::path(testing::TempDir()) / (std::string(board().name) + "_costs.elf");
  std::filesystem::copy_file(bare_firmware(board()), image,
                             std::filesystem::copy_options::overwrite_existing);
  const bound::BoundOptions options = in_cycles(board());
  bound::embed(image, bound::tick_costs(options));
  EXPECT_EQ(bound::embedded(image).known, core::kTickCostsKnown);
  ASSERT_EQ(std::system((TACTREE_SOURCES "/scripts/seal-image " + image.string()).c_str()), 0);

  core::TickLoad load;
  load.add(touched_shape().view().header(), {});
  bound::PaceCycles cycles{};
  for (load.pace = 0; load.pace < core::kPaces; ++load.pace) {
    cycles[load.pace] = static_cast<double>(core::cycles_of(bound::embedded(image), load));
  }
  const double highest = bound::highest_rate(options.timing->clock_hz, cycles);
  std::printf("%s: highest rate admitted %.0f Hz\n", board().name, highest);
  const hal::StartResult refused = start_at(board(), image, 1.01 * std::max(highest, 100.0));
  EXPECT_EQ(refused.model, core::ModelStatus::kTooSlow) << core::describe(refused.configuration);
  if (highest > 101.0) {  // the lowest rate of all
    EXPECT_TRUE(start_at(board(), image, 0.99 * highest).ok());
  }
  std::filesystem::remove(image);
}

// The test of the tests: where an annotation says less than the code does, a run shows it.
TEST_P(Proof, ATooSmallBoundIsFound) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("too_small_" + std::string(board().name));
  std::filesystem::create_directories(folder);
  for (const char* part : {"core", "hal", "firmware"}) {
    std::filesystem::copy(std::filesystem::path(TACTREE_SOURCES) / part, folder / part,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
  }
  const std::filesystem::path file = folder / "core/src/surface.cpp";
  std::string text = read_text(file);
  const std::string honest = "// bound: points_per_ball_max";
  for (std::size_t at = 0; (at = text.find(honest, at)) != std::string::npos; ++at) {
    text.replace(at, honest.size(), "// bound: points_per_ball_max / 2");
  }
  std::ofstream(file) << text;

  const TestBlob blob(nasty_model(Nastiness::kEdge));
  constexpr float kRate_hz = 4000.0F;  // where the bound is tightest
  const bound::Bound bound = bound_of(board(), blob.view(), core::RenderMode::kSurface, kRate_hz,
                                      core::DeviceKind::kCartesian, folder);
  const Found found = seek_worst(board(), options(), blob.written().bytes, kSize_m, kRuns,
                                 core::RenderMode::kSurface, kRate_hz, 1);
  EXPECT_GT(found.instructions, bound.instructions);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tactree::test
