#include "normals/outside.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "geometry/cloud.hpp"

namespace tactree::builder {
namespace {

constexpr double kCellsPerRadius = 2.5;
constexpr int kBlock = 8;                    // cells on an edge
constexpr double kMaxBlocks = 16'777'216.0;  // 2^24
// A ball that touches an element has its centre near the normal, at a distance of the radius and up
// to 1.2 cells more, because centres are rounded to cells.
constexpr int kProbeSteps = 3;
constexpr float kProbeStepCells = 0.55F;
const std::array<Eigen::Vector3f, 7> kProbes = [] {
  std::array<Eigen::Vector3f, 7> probes;
  probes[0] = Eigen::Vector3f::UnitZ();
  for (std::size_t k = 0; k < 6; ++k) {
    const double tilt = 0.7;
    const double angle = std::numbers::pi / 3.0 * static_cast<double>(k);
    probes[k + 1] = Eigen::Vector3d(std::sin(tilt) * std::cos(angle),
                                    std::sin(tilt) * std::sin(angle), std::cos(tilt))
                        .cast<float>();
  }
  return probes;
}();

constexpr std::uint64_t kFirstColumn = 0x0101010101010101U;  // x = 0
constexpr std::uint64_t kLastColumn = 0x8080808080808080U;   // x = 7

// Extends `seeds` to all cells that can be reached from them inside one block of free cells.
void fill(const std::array<std::uint64_t, 8>& open, std::array<std::uint64_t, 8>& seeds) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t z = 0; z < 8; ++z) {
      std::uint64_t s = seeds[z] | (z > 0 ? seeds[z - 1] : 0) | (z < 7 ? seeds[z + 1] : 0);
      s |= (s & ~kLastColumn) << 1 | (s & ~kFirstColumn) >> 1 | s << 8 | s >> 8;
      s &= open[z];
      changed = changed || s != seeds[z];
      seeds[z] = s;
    }
  }
}

// Adds the cells of a block that touch reached cells of its neighbour across a face.
void enter(const std::array<std::uint64_t, 8>& neighbour, std::size_t face,
           std::array<std::uint64_t, 8>& seeds) {
  if (face == 4) {
    seeds[0] |= neighbour[7];
    return;
  }
  if (face == 5) {
    seeds[7] |= neighbour[0];
    return;
  }
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t n = neighbour[z];
    switch (face) {
      case 0:
        seeds[z] |= (n & kLastColumn) >> 7;
        break;
      case 1:
        seeds[z] |= (n & kFirstColumn) << 7;
        break;
      case 2:
        seeds[z] |= n >> 56;
        break;
      default:
        seeds[z] |= n << 56;
        break;
    }
  }
}

}  // namespace

Outside::Outside(std::span<const Eigen::Vector3d> positions, double radius)
    : radius_(radius), edge_(radius / kCellsPerRadius) {
  lay_out(positions);
  block_around(positions);
  flood();
}

void Outside::lay_out(std::span<const Eigen::Vector3d> positions) {
  const Box box = bounds_of(positions);
  for (;;) {
    const double margin = radius_ + kBlock * edge_;
    origin_ = box.min().array() - margin;
    const Eigen::Array3d wanted =
        ((box.sizes().array() + 2.0 * margin) / (kBlock * edge_)).ceil() + 1.0;
    if (wanted.prod() <= kMaxBlocks) {
      blocks_ = wanted.cast<int>();
      break;
    }
    radius_ *= 1.25;
    edge_ *= 1.25;
  }
  near_.assign(block_of(0, 0, blocks_.z()), kFar);
  far_reached_.assign(near_.size(), 0);
}

// Blocks the cells `first` to `last` of a row. In a block, a row is one byte of a layer.
void Outside::block_row(int first, int last, int y, int z) {
  for (int x = first; x <= last; x = (x | 7) + 1) {
    Bits& free = free_[near_[block_of(x >> 3, y >> 3, z >> 3)] - 1];
    const int end = std::min(last, x | 7);
    const std::uint64_t cells = (2U << (end & 7)) - (1U << (x & 7));
    const std::atomic_ref layer(free[static_cast<std::size_t>(z & 7)]);
    if ((layer.load(std::memory_order_relaxed) & cells << (8 * (y & 7))) != 0) {
      layer.fetch_and(~(cells << (8 * (y & 7))), std::memory_order_relaxed);
    }
  }
}

// Blocks the cells within the radius of a point.
void Outside::block_ball(const Eigen::Vector3d& p) {
  const double squared = radius_ * radius_;
  const double middle = (p.x() - origin_.x()) / edge_ - 0.5;
  const Eigen::Vector3i low = cell_at(p.array() - radius_);
  const Eigen::Vector3i high = cell_at(p.array() + radius_);
  for (int z = low.z(); z <= high.z(); ++z) {
    const double dz = origin_.z() + edge_ * (z + 0.5) - p.z();
    for (int y = low.y(); y <= high.y(); ++y) {
      const double dy = origin_.y() + edge_ * (y + 0.5) - p.y();
      const double left = squared - dz * dz - dy * dy;
      if (left < 0.0) {
        continue;
      }
      const double half_row = std::sqrt(left) / edge_;
      // Both ends are positive because of the margin; a conversion rounds them down.
      const auto before = static_cast<int>(middle - half_row);
      const bool at_centre = static_cast<double>(before) == middle - half_row;
      block_row(at_centre ? before : before + 1, static_cast<int>(middle + half_row), y, z);
    }
  }
}

// Gives a bitmap to each block that the ball around a point may touch.
void Outside::mark_blocks(const Eigen::Vector3d& p) {
  // By rounding, a position may seem to touch the outermost layer of blocks.
  const Eigen::Vector3i low = cell_at(p.array() - radius_).array().max(kBlock);
  const Eigen::Vector3i high = cell_at(p.array() + radius_);
  for (int z = low.z() >> 3; z <= high.z() >> 3; ++z) {
    for (int y = low.y() >> 3; y <= high.y() >> 3; ++y) {
      for (int x = low.x() >> 3; x <= high.x() >> 3; ++x) {
        std::atomic_ref(near_[block_of(x, y, z)]).store(1, std::memory_order_relaxed);
      }
    }
  }
}

void Outside::block_around(std::span<const Eigen::Vector3d> positions) {
  const auto half_cell = [&](std::size_t i) -> Eigen::Vector3i {
    return (2.0 * (positions[i] - origin_) / edge_).cast<int>();
  };
  const auto for_each = [&](auto&& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](auto range) {
      // Consecutive points in the same half cell are skipped, because one of them is enough.
      Eigen::Vector3i last = Eigen::Vector3i::Constant(-1);
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Eigen::Vector3i half = half_cell(i);
        const bool repeats = i == range.begin() ? i > 0 && half == half_cell(i - 1) : half == last;
        last = half;
        if (!repeats) {
          work(positions[i]);
        }
      }
    });
  };
  for_each([&](const Eigen::Vector3d& p) { mark_blocks(p); });
  std::uint32_t count = 0;
  for (std::uint32_t& slot : near_) {
    slot = slot == kFar ? kFar : ++count;
  }
  Bits all;
  all.fill(~std::uint64_t{0});
  free_.assign(count, all);
  for_each([&](const Eigen::Vector3d& p) { block_ball(p); });
  reached_.assign(count, Bits{});
}

Outside::Bits Outside::reached_bits(std::size_t block) const {
  if (near_[block] != kFar) {
    return reached_[near_[block] - 1];
  }
  Bits bits;
  bits.fill(far_reached_[block] != 0 ? ~std::uint64_t{0} : 0);
  return bits;
}

std::array<std::size_t, 6> Outside::neighbours_of(std::size_t block) const {
  const auto row = static_cast<std::size_t>(blocks_.x());
  const std::size_t layer = row * static_cast<std::size_t>(blocks_.y());
  return {block - 1, block + 1, block - row, block + row, block - layer, block + layer};
}

// Adds the cells of a block with a bitmap that can be reached from its neighbours. Returns true if
// there are any.
bool Outside::spread(std::size_t block) {
  Bits& reached = reached_[near_[block] - 1];
  const Bits& open = free_[near_[block] - 1];
  Bits seeds = reached;
  const std::array<std::size_t, 6> neighbours = neighbours_of(block);
  for (std::size_t face = 0; face < 6; ++face) {
    enter(reached_bits(neighbours[face]), face, seeds);
  }
  for (std::size_t z = 0; z < 8; ++z) {
    seeds[z] &= open[z];
  }
  if (seeds == reached) {
    return false;
  }
  fill(open, seeds);
  reached = seeds;
  return true;
}

// Spreads into a block with a bitmap. Returns the neighbours that it touches, if it has changed.
std::vector<std::size_t> Outside::entered_from(std::size_t block) {
  std::vector<std::size_t> entered;
  if (!spread(block)) {
    return entered;
  }
  const std::array<std::size_t, 6> neighbours = neighbours_of(block);
  for (std::size_t face = 0; face < 6; ++face) {
    Bits beyond{};
    enter(reached_bits(block), face ^ 1U, beyond);  // faces: 0 -x, 1 +x, 2 -y, ...
    if (beyond != Bits{}) {
      entered.push_back(neighbours[face]);
    }
  }
  return entered;
}

// The outermost layer of blocks surrounds the grid; it is marked as reached and never visited.
void Outside::reach_border() {
  for (int z = 0; z < blocks_.z(); ++z) {
    for (int y = 0; y < blocks_.y(); ++y) {
      const bool face = z == 0 || z == blocks_.z() - 1 || y == 0 || y == blocks_.y() - 1;
      for (int x = 0; x < blocks_.x(); x += face ? 1 : blocks_.x() - 1) {
        far_reached_[block_of(x, y, z)] = 1;
      }
    }
  }
}

void Outside::flood() {
  reach_border();
  std::vector<std::size_t> far;
  std::vector<std::size_t> waiting;
  std::vector<std::size_t> now;
  std::vector<std::uint8_t> queued(near_.size(), 0);
  const auto visit = [&](std::size_t block) {
    if (near_[block] == kFar) {
      if (far_reached_[block] == 0) {
        far_reached_[block] = 1;
        far.push_back(block);
      }
    } else if (queued[block] == 0) {
      queued[block] = 1;
      waiting.push_back(block);
    }
  };
  visit(block_of(1, 1, 1));
  while (!far.empty() || !waiting.empty()) {
    while (!far.empty()) {
      const std::size_t block = far.back();
      far.pop_back();
      for (const std::size_t neighbour : neighbours_of(block)) {
        visit(neighbour);
      }
    }
    now.swap(waiting);
    waiting.clear();
    for (const std::size_t block : now) {
      queued[block] = 0;
      for (const std::size_t neighbour : entered_from(block)) {
        visit(neighbour);
      }
    }
  }
}

bool Outside::reached_cell(const Eigen::Vector3f& in_cells) const {
  // Every probe lies in the grid, because its margin is wider than the range of a probe.
  const Eigen::Vector3i cell = in_cells.cast<int>();
  const std::size_t block = block_of(cell.x() >> 3, cell.y() >> 3, cell.z() >> 3);
  if (near_[block] == kFar) {
    return far_reached_[block] != 0;
  }
  const std::uint64_t layer = reached_[near_[block] - 1][static_cast<std::size_t>(cell.z() & 7)];
  return (layer >> (8 * (cell.y() & 7) + (cell.x() & 7)) & 1U) != 0;
}

Outside::Side Outside::side_of(const Eigen::Vector3d& position,
                               const Eigen::Vector3f& normal) const {
  // Position in cells, and two unit vectors that are perpendicular to the normal.
  const Eigen::Vector3f at = ((position - origin_) / edge_).cast<float>();
  const Eigen::Vector3f u = normal.unitOrthogonal();
  const Eigen::Vector3f v = normal.cross(u);
  bool ahead = false;
  bool behind = false;
  for (const Eigen::Vector3f& direction : kProbes) {
    const Eigen::Vector3f plane = direction.x() * u + direction.y() * v;
    const Eigen::Vector3f rise = direction.z() * normal;
    for (int step = 0; step < kProbeSteps && !(ahead && behind); ++step) {
      const float distance =
          static_cast<float>(kCellsPerRadius) + kProbeStepCells * static_cast<float>(step);
      ahead = ahead || reached_cell(at + distance * (plane + rise));
      behind = behind || reached_cell(at + distance * (plane - rise));
    }
  }
  if (ahead == behind) {
    return {0.0F, ahead};
  }
  return {ahead ? 1.0F : -1.0F, false};
}

}  // namespace tactree::builder
