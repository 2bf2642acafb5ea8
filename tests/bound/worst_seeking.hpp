#pragma once
// Looks for the tick that takes a board the most instructions.

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "tactree/builder/model.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {

/// Models made to be expensive: as many points as a controller accepts in one ball, all of which
/// are within the support of the fit wherever the probe comes near, in eight leaves of a tree of
/// great depth, and of two faces, or of none, or nearly all on the longest way through a fit: askew
/// to the face that is looked from, and to each other.
enum class Nastiness { kEdge, kRandomNormals, kAskew };
[[nodiscard]] builder::Model nasty_model(Nastiness kind);

/// Where the probe is in successive ticks, m, the model at the origin. It jumps as it likes.
using Way = std::vector<core::Vec3>;

/// A run along a way, armed or not, on an emulated board with a cartesian device.
[[nodiscard]] emulation::InstructionCounts follow(const emulation::BoardDescription& board,
                                                  emulation::EmulationOptions options,
                                                  std::span<const std::byte> blob, const Way& way,
                                                  core::RenderMode mode, float rate_hz);

struct Found {
  std::uint64_t instructions = 0;
  Way way;  ///< the ticks that led there
  std::vector<emulation::CodeRange> code;
  std::vector<emulation::DataRange> data;
};

/// Climbs on the instruction count: the ways around the worst tick of one run, changed a little,
/// are the next run. `size_m`: how far from the origin it makes sense to be.
[[nodiscard]] Found seek_worst(const emulation::BoardDescription& board,
                               const emulation::EmulationOptions& options,
                               std::span<const std::byte> blob, float size_m, int runs,
                               core::RenderMode mode, float rate_hz, std::uint32_t seed);

}  // namespace tactree::test
