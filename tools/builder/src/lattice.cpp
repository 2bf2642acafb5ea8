#include "lattice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tactree::builder {
namespace {

constexpr int kMostStepBits = 12;  // finer than 0.03 %: nothing would be gained

// Smallest float32 with `bits` significant bits that is >= v.
double round_up(double v, int bits) {
  int exponent = 0;
  const double fraction = std::frexp(v, &exponent);
  return std::ldexp(std::ceil(std::ldexp(fraction, bits)), exponent - bits);
}

// Bits that the largest coordinate of the root cube needs: |coordinate| <= 2^bits.
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

// Places a root cube of whole leaves around the bounds; false when no allowed depth holds them.
bool place_root(const Eigen::Vector3d& low, const Eigen::Vector3d& high, Lattice& lattice) {
  const double leaf = lattice.step_m * core::kLeafUnits;
  const Eigen::Array3d first = (low.array() / leaf - 0.001).floor();
  const Eigen::Array3d last = (high.array() / leaf + 0.001).floor();
  const double cells = (last - first).maxCoeff() + 1.0;
  lattice.depth = 1;
  while (lattice.depth < core::kMaxDepth && std::ldexp(1.0, static_cast<int>(lattice.depth)) < cells) {
    ++lattice.depth;
  }
  const double across = std::ldexp(1.0, static_cast<int>(lattice.depth));
  if (across < cells) {
    return false;
  }
  // The model sits in the middle of the root, so that coordinates stay small.
  const Eigen::Array3d corner = (first - ((across - 1.0 - (last - first)) / 2.0).floor()) * core::kLeafUnits;
  const double limit = core::kMaxCoordinate;
  if (corner.minCoeff() < -limit || corner.maxCoeff() + across * core::kLeafUnits > limit) {
    return false;
  }
  lattice.root_min = {static_cast<std::int32_t>(corner.x()), static_cast<std::int32_t>(corner.y()),
                      static_cast<std::int32_t>(corner.z())};
  return true;
}

}  // namespace

Lattice choose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double leaf_edge_m) {
  const double wanted = leaf_edge_m / core::kLeafUnits;
  for (int bits = kMostStepBits; bits >= 1; --bits) {
    Lattice lattice;
    lattice.step_m = round_up(wanted, bits);
    if (place_root(low, high, lattice) && coordinate_bits(lattice) + bits <= 24) {
      return lattice;
    }
  }
  throw std::runtime_error(fmt::format(
      "the model spans {:.6g} m, too much for octree leaves of {:.3g} m (at most {} across); "
      "choose a larger spacing, or crop or centre the model",
      (high - low).maxCoeff(), leaf_edge_m, 1U << core::kMaxDepth));
}

}  // namespace tactree::builder
