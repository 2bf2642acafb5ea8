#pragma once
// Searches for the tick with the most instructions on a board.

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "tactree/builder/model.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {

/// Expensive models: as many points as a controller accepts in one ball, all within the support of
/// the fit, in eight leaves of a deep tree. Their normals: of two faces; random; or oblique to the
/// face of the fit and to each other, which takes the longest path through a fit.
enum class ExpensiveModel { kEdge, kRandomNormals, kOblique };
[[nodiscard]] builder::Model expensive_model(ExpensiveModel kind);

/// Positions of the probe in successive ticks, m, with the model at the origin. Jumps are allowed.
using ProbePath = std::vector<core::Vec3>;

/// Runs an emulated board with a cartesian device along a path.
[[nodiscard]] emulation::InstructionCounts follow(const emulation::BoardDescription& board,
                                                  emulation::EmulationOptions options,
                                                  std::span<const std::byte> blob,
                                                  const ProbePath& path, core::RenderMode mode,
                                                  float rate_hz);

struct Found {
  std::uint64_t instructions = 0;
  ProbePath path;  ///< the ticks up to the worst one
  std::vector<emulation::CodeRange> code;
  std::vector<emulation::DataRange> data;
};

/// Hill climbing on the instruction count: each run follows variations of the path that led to the
/// worst tick so far. `size_m`: range of the probe around the origin.
[[nodiscard]] Found seek_worst(const emulation::BoardDescription& board,
                               const emulation::EmulationOptions& options,
                               std::span<const std::byte> blob, float size_m, int runs,
                               core::RenderMode mode, float rate_hz, std::uint32_t seed);

}  // namespace tactree::test
