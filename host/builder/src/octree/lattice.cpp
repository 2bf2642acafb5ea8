#include "octree/lattice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tactree/builder/length_text.hpp"

namespace tactree::builder {
namespace {

constexpr int kMaxStepBits = 12;  // 0.03 % resolution of the step suffices

// Smallest float32 with `bits` significant bits that is >= v.
double round_up(double v, int bits) {
  int exponent = 0;
  const double fraction = std::frexp(v, &exponent);
  return std::ldexp(std::ceil(std::ldexp(fraction, bits)), exponent - bits);
}

// Bits of the largest coordinate of the root cube: |coordinate| <= 2^bits.
int coordinate_bits(const Lattice& lattice) {
  const std::int64_t edge = std::int64_t{core::kLeafUnits} << lattice.depth;
  std::int64_t largest = 1;
  for (const std::int64_t low : {lattice.root_min.x, lattice.root_min.y, lattice.root_min.z}) {
    largest = std::max({largest, std::abs(low), std::abs(low + edge)});
  }
  int bits = 0;
  while ((std::int64_t{1} << bits) < largest) {
    ++bits;
  }
  return bits;
}

// Places a root cube of whole leaves around the bounds. Returns false if no allowed depth contains
// them.
bool place_root(const Eigen::Vector3d& low, const Eigen::Vector3d& high, Lattice& lattice) {
  const double leaf = lattice.step_m * core::kLeafUnits;
  const Eigen::Array3d first = (low.array() / leaf - 0.001).floor();
  const Eigen::Array3d last = (high.array() / leaf + 0.001).floor();
  const double cells = (last - first).maxCoeff() + 1.0;
  lattice.depth = 1;
  while (lattice.depth < core::kMaxDepth &&
         std::ldexp(1.0, static_cast<int>(lattice.depth)) < cells) {
    ++lattice.depth;
  }
  const double across = std::ldexp(1.0, static_cast<int>(lattice.depth));
  if (across < cells) {
    return false;
  }
  // Centres the model in the root to keep coordinates small.
  const Eigen::Array3d corner =
      (first - ((across - 1.0 - (last - first)) / 2.0).floor()) * core::kLeafUnits;
  const double limit = core::kMaxCoordinate;
  if (corner.minCoeff() < -limit || corner.maxCoeff() + across * core::kLeafUnits > limit) {
    return false;
  }
  lattice.root_min = {static_cast<std::int32_t>(corner.x()), static_cast<std::int32_t>(corner.y()),
                      static_cast<std::int32_t>(corner.z())};
  return true;
}

// Centres a root cube of the given depth and step on the bounds. Returns false if they do not fit.
bool place_around(const Eigen::Vector3d& low, const Eigen::Vector3d& high, Lattice& lattice) {
  const double units = std::ldexp(core::kLeafUnits, static_cast<int>(lattice.depth));
  const Eigen::Array3d first = low.array() / lattice.step_m;
  const Eigen::Array3d last = high.array() / lattice.step_m;
  const Eigen::Array3d corner = (0.5 * (first + last - units)).round();
  if (corner.abs().maxCoeff() + units > core::kMaxCoordinate) {
    return false;
  }
  lattice.root_min = {static_cast<std::int32_t>(corner.x()), static_cast<std::int32_t>(corner.y()),
                      static_cast<std::int32_t>(corner.z())};
  return (first >= corner).all() && (last <= corner + units).all();
}

[[noreturn]] void refuse(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         double leaf_edge) {
  throw std::runtime_error(fmt::format(
      "the model spans {}, at up to {} from the origin: too much for octree leaves of {} (choose a "
      "larger spacing, or crop or centre the model)",
      length_text((high - low).maxCoeff(), 6),
      length_text(low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff(), 6),
      length_text(leaf_edge, 3)));
}

}  // namespace

Lattice choose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       double leaf_edge_m) {
  for (int bits = kMaxStepBits; bits >= 1; --bits) {
    Lattice lattice;
    lattice.step_m = round_up(leaf_edge_m / core::kLeafUnits, bits);
    if (place_root(low, high, lattice) && coordinate_bits(lattice) + bits <= 24) {
      return lattice;
    }
  }
  refuse(low, high, leaf_edge_m);
}

Lattice bounding_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         std::uint32_t depth) {
  const double units = std::ldexp(core::kLeafUnits, static_cast<int>(depth));
  const double extent = (high - low).maxCoeff();
  for (int bits = kMaxStepBits; bits >= 1; --bits) {
    // First tries a root as wide as the model, then one that is two units wider, because the corner
    // of the root is rounded to whole units.
    for (const double across : {units, units - 2.0}) {
      Lattice lattice;
      lattice.depth = depth;
      lattice.step_m = round_up(extent / across, bits);
      if (place_around(low, high, lattice) && coordinate_bits(lattice) + bits <= 24) {
        return lattice;
      }
    }
  }
  refuse(low, high, extent / units * core::kLeafUnits);
}

}  // namespace tactree::builder
