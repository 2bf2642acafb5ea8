#include "sampling/resample.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace tactree::builder {
namespace {

// Space is divided into tiles several distances wide. Tiles that do not touch cannot influence each
// other, so tiles with equal parity of all three coordinates are processed in parallel, one parity
// after the other. The result does not depend on the order of the threads.
constexpr double kTileDistances = 6.0;
constexpr int kMaxCellsPerAxis = 16;  // in the local grid of a tile

struct Tile {
  CellRange range;
  Eigen::Vector3i cell;
  std::vector<std::uint32_t> kept;
};

// Cell of the middle of 27, and the others by their distance from it: most points have a competitor
// in their own cell.
constexpr std::array<std::array<int, 3>, 27> cells_from_the_middle() {
  std::array<std::array<int, 3>, 27> cells{};
  std::size_t count = 0;
  for (int away = 0; away <= 3; ++away) {
    for (int k = 0; k < 27; ++k) {
      const std::array<int, 3> cell = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
      if (cell[0] * cell[0] + cell[1] * cell[1] + cell[2] * cell[2] == away) {
        cells[count++] = cell;
      }
    }
  }
  return cells;
}

// The kept points in and around one tile, in a small dense grid with a margin of empty cells.
class LocalGrid {
 public:
  // Cells are at least `distance` wide, so competitors lie in the 27 cells around a point.
  LocalGrid(const Eigen::Vector3d& corner, double edge, double distance)
      : corner_(corner.array() - distance) {
    const double width = edge + 2.0 * distance;
    per_axis_ = std::clamp(static_cast<int>(width / distance), 1, kMaxCellsPerAxis);
    scale_ = per_axis_ / width;
    row_ = per_axis_ + 2;
    const auto row = static_cast<std::size_t>(row_);
    heads_.assign(row * row * row, kEnd);
    constexpr auto kCells = cells_from_the_middle();
    for (std::size_t k = 0; k < kCells.size(); ++k) {
      offsets_[k] = (kCells[k][2] * row_ + kCells[k][1]) * row_ + kCells[k][0];
    }
  }

  [[nodiscard]] bool covers(const Eigen::Vector3d& p) const {
    const Eigen::Array3d at = (p - corner_).array() * scale_;
    return (at >= 0.0).all() && (at <= static_cast<double>(per_axis_)).all();
  }
  void add(const Eigen::Vector3d& p, std::uint32_t index) {
    std::uint32_t& head = heads_[static_cast<std::size_t>(cell_of(p))];
    links_.push_back({p, index, head});
    head = static_cast<std::uint32_t>(links_.size() - 1);
  }
  // True if any(position, index) holds for a point in the 27 cells around p.
  template <typename Any>
  [[nodiscard]] bool any_near(const Eigen::Vector3d& p, Any&& any) const {
    const int middle = cell_of(p);
    for (const int offset : offsets_) {
      const int cell = middle + offset;
      for (std::uint32_t k = heads_[static_cast<std::size_t>(cell)]; k != kEnd;
           k = links_[k].next) {
        if (any(links_[k].position, links_[k].index)) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kEnd = ~0U;
  struct Link {
    Eigen::Vector3d position;
    std::uint32_t index;
    std::uint32_t next;
  };

  [[nodiscard]] int cell_of(const Eigen::Vector3d& p) const {
    const Eigen::Array3i cell =
        ((p - corner_).array() * scale_).cast<int>().max(0).min(per_axis_ - 1) + 1;
    return (cell.z() * row_ + cell.y()) * row_ + cell.x();
  }

  Eigen::Vector3d corner_;
  double scale_ = 1.0;
  int per_axis_ = 1;
  int row_ = 3;  // cells of an axis with the margin
  std::array<int, 27> offsets_{};
  std::vector<std::uint32_t> heads_;
  std::vector<Link> links_;
};

class Selection {
 public:
  Selection(const ZOrderedCloud& points, double distance)
      : points_(points),
        distance_(distance),
        level_(points.level_for_edge(kTileDistances * distance)) {
    for (const CellRange& range : points.cells(level_)) {
      const Eigen::Vector3i cell = points.cell_of(range.first, level_);
      const int parity = (cell.x() & 1) | (cell.y() & 1) << 1 | (cell.z() & 1) << 2;
      by_parity_[static_cast<std::size_t>(parity)].push_back(
          static_cast<std::uint32_t>(tiles_.size()));
      tile_at_.emplace(key(cell), static_cast<std::uint32_t>(tiles_.size()));
      tiles_.push_back({range, cell, {}});
    }
  }

  void run() {
    for (const std::vector<std::uint32_t>& phase : by_parity_) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, phase.size(), 4), [&](auto range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          work_on(tiles_[phase[i]]);
        }
      });
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> kept() const {
    std::vector<std::uint32_t> all;
    for (const Tile& tile : tiles_) {
      all.insert(all.end(), tile.kept.begin(), tile.kept.end());
    }
    return all;
  }

 private:
  static std::uint64_t key(const Eigen::Vector3i& cell) {
    return static_cast<std::uint64_t>(cell.x()) | static_cast<std::uint64_t>(cell.y()) << 21 |
           static_cast<std::uint64_t>(cell.z()) << 42;
  }

  [[nodiscard]] bool face_the_same_side(std::uint32_t a, std::uint32_t b) const {
    if (!points_.cloud().has_normals()) {
      return true;
    }
    const Eigen::Vector3f& n = points_.normals()[a];
    const Eigen::Vector3f& m = points_.normals()[b];
    return n.isZero() || m.isZero() || n.dot(m) > kSameSideCosine;
  }

  void add_neighbours(const Tile& tile, LocalGrid& grid) const {
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i at = tile.cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const auto found = (at.array() >= 0).all() ? tile_at_.find(key(at)) : tile_at_.end();
      if (k == 13 || found == tile_at_.end()) {
        continue;
      }
      for (const std::uint32_t i : tiles_[found->second].kept) {
        if (grid.covers(points_.positions()[i])) {
          grid.add(points_.positions()[i], i);
        }
      }
    }
  }

  void work_on(Tile& tile) const {
    LocalGrid grid(points_.cell_corner(tile.cell, level_), points_.cell_edge(level_), distance_);
    add_neighbours(tile, grid);
    // Copied, because the order below is random.
    const auto& all = points_.positions();
    const std::vector<Eigen::Vector3d> positions(all.begin() + tile.range.first,
                                                 all.begin() + tile.range.last);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    order.reserve(positions.size());
    for (std::uint32_t i = tile.range.first; i < tile.range.last; ++i) {
      order.emplace_back(hash64(i), i);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [hash, i] : order) {
      const Eigen::Vector3d& p = positions[i - tile.range.first];
      const auto competes = [&, i = i](const Eigen::Vector3d& other_p, std::uint32_t other) {
        return (p - other_p).squaredNorm() < distance_ * distance_ && face_the_same_side(i, other);
      };
      if (!grid.any_near(p, competes)) {
        tile.kept.push_back(i);
        grid.add(p, i);
      }
    }
    std::sort(tile.kept.begin(), tile.kept.end());
  }

  const ZOrderedCloud& points_;
  double distance_;
  int level_;
  std::vector<Tile> tiles_;
  std::array<std::vector<std::uint32_t>, 8> by_parity_;
  std::unordered_map<std::uint64_t, std::uint32_t> tile_at_;
};

}  // namespace

std::vector<std::uint32_t> select_poisson_disk(const ZOrderedCloud& points, double distance) {
  Selection selection(points, distance);
  selection.run();
  return selection.kept();
}

}  // namespace tactree::builder
