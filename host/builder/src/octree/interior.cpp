#include "octree/interior.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/disjoint_sets.hpp"
#include "geometry/local_points.hpp"
#include "geometry/point_grid.hpp"
#include "octree/octree_builder.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::builder {
namespace {

// Radius of the neighbourhood of a point, in spacings.
constexpr double kNear = 2.0;
// Edge of the blocks of points that are searched together, in such radii.
constexpr double kBlockRadii = 2.0;
// Maximum area of a point, in squared spacings, because a point at a border has half the
// neighbours.
constexpr double kMaxArea = 2.0;

// Threshold of the winding number on the surface of a body. The winding number is 1/2 (the mean of
// both sides) on a closed surface, 0 on a flat sheet and 1/4 on half a sphere.
constexpr double kBody = 0.3;
// Number of samples of a component.
constexpr std::uint32_t kSamples = 2048;

struct Neighbourhood {
  std::vector<double> areas;            // of each point, m^2
  std::vector<std::uint32_t> piece_of;  // the lowest point of its component
};

Neighbourhood look_at_neighbours(const OrientedPoints& points) {
  const auto count = static_cast<std::uint32_t>(points.positions.size());
  const double radius = kNear * points.spacing;
  const PointGrid grid(points.positions, kBlockRadii * radius);
  Neighbourhood result;
  result.areas.resize(count);
  DisjointSets sets(count);
  const auto look_from = [&](LocalPoints& local, std::uint32_t i) {
    int near = 0;
    local.visit_within(points.positions[i], radius, [&](std::uint32_t other, double) {
      if (points.normals[i].dot(points.normals[other]) > 0.0F) {
        ++near;
        if (other < i) {
          sets.join(i, other);
        }
      }
    });
    result.areas[i] = std::min(std::numbers::pi * radius * radius / std::max(near, 1),
                               kMaxArea * points.spacing * points.spacing);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.cell_count(), 16), [&](auto range) {
    LocalPoints local;
    for (std::size_t cell = range.begin(); cell < range.end(); ++cell) {
      Box box;
      for (const std::uint32_t i : grid.points_of(cell)) {
        box.extend(points.positions[i]);
      }
      local.gather_from(box, radius, [&](auto&& visit) {
        grid.visit_near(box.center(), radius + 0.5 * largest_edge(box),
                        [&](std::uint32_t i) { visit(points.positions[i], i); });
      });
      for (const std::uint32_t i : grid.points_of(cell)) {
        look_from(local, i);
      }
    }
  });
  result.piece_of.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    result.piece_of[i] = sets.find(i);
  }
  return result;
}

std::vector<SurfaceElement> elements_of(const OrientedPoints& points,
                                        std::span<const double> areas) {
  std::vector<SurfaceElement> elements;
  elements.reserve(areas.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    elements.push_back({points.positions[i], areas[i] * points.normals[i].cast<double>()});
  }
  return elements;
}

double turns(double angle) { return angle / (4.0 * std::numbers::pi); }

}  // namespace

Interior::Interior(const OrientedPoints& points) : tree_({}) {
  const Neighbourhood near = look_at_neighbours(points);
  tree_ = WindingTree(elements_of(points, near.areas));
  find_bodies(points, near.piece_of);
}

void Interior::find_bodies(const OrientedPoints& points, std::span<const std::uint32_t> piece_of) {
  const std::size_t count = piece_of.size();
  struct Piece {
    std::uint32_t points = 0;
    std::uint32_t seen = 0;
    std::uint32_t doubtful = 0;
    std::uint32_t samples = 0;
    double sum = 0.0;
  };
  std::vector<Piece> pieces(count);  // by lowest point
  for (const std::uint32_t piece : piece_of) {
    ++pieces[piece].points;
  }
  std::vector<std::uint32_t> samples;
  for (std::uint32_t i = 0; i < count; ++i) {
    Piece& piece = pieces[piece_of[i]];
    piece.doubtful += points.doubtful.empty() ? 0U : points.doubtful[i];
    if (piece.seen++ % (piece.points / kSamples + 1U) == 0U) {
      samples.push_back(i);
    }
  }
  std::vector<double> at_sample(samples.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples.size(), 64), [&](auto range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      at_sample[k] = turns(tree_.angle(points.positions[samples[k]]));
    }
  });
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Piece& piece = pieces[piece_of[samples[k]]];
    ++piece.samples;
    piece.sum += at_sample[k];
  }
  backed_.resize(count);
  std::size_t backed = 0;
  double outwards = 0.0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Piece& piece = pieces[piece_of[i]];
    const double mean = piece.sum / piece.samples;
    const bool is_body = std::abs(mean) > kBody && 2U * piece.doubtful <= piece.points;
    backed_[i] = is_body ? 1 : 0;
    backed += backed_[i];
    outwards += is_body ? mean : 0.0;
  }
  backed_share_ = count == 0 ? 0.0 : static_cast<double>(backed) / static_cast<double>(count);
  outermost_ = outwards < 0.0 ? 1.0 : 0.0;
}

bool Interior::is_material(const Eigen::Vector3d& at) const {
  return backed_share_ > 0.0 && outermost_ + turns(tree_.angle(at)) > 0.5;
}

namespace {

class Marker {
 public:
  Marker(const Interior& interior, const Octree& tree)
      : interior_(interior), tree_(tree), bytes_(tree.nodes.size() + tree.leaves.size()) {}

  std::vector<std::uint8_t> run() {
    mark_below(0, 0, {});
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells_.size(), 64), [&](auto range) {
      for (std::size_t k = range.begin(); k != range.end(); ++k) {
        cells_[k].is_material = interior_.is_material(cells_[k].centre);
      }
    });
    for (const Cell& cell : cells_) {
      bytes_[cell.byte] |= static_cast<std::uint8_t>((cell.is_material ? 1U : 0U) << cell.octant);
    }
    return std::move(bytes_);
  }

 private:
  struct Cell {
    Eigen::Vector3d centre;
    std::size_t byte;
    std::uint32_t octant;
    bool is_material = false;
  };

  // Cell coordinates in cells of `level`.
  void add(core::Int3 cell, std::uint32_t level, std::size_t byte, std::uint32_t octant) {
    const Lattice& lattice = tree_.lattice;
    const double edge = std::ldexp(static_cast<double>(core::kLeafUnits),
                                   static_cast<int>(lattice.depth) - static_cast<int>(level));
    const auto middle = [&](std::int32_t root, std::int32_t at) {
      return lattice.step_m * (root + edge * (at + 0.5));
    };
    cells_.push_back({{middle(lattice.root_min.x, cell.x), middle(lattice.root_min.y, cell.y),
                       middle(lattice.root_min.z, cell.z)},
                      byte,
                      octant});
  }

  void mark_below(std::uint32_t node, std::uint32_t level, core::Int3 cell) {
    const core::BlobNode here = tree_.nodes[node];
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const core::Int3 child = core::child_cell(cell, octant);
      if ((here.nodes >> 24 >> octant & 1U) != 0) {
        mark_below(core::child_node(here, octant), level + 1U, child);
      } else if ((here.leaves >> 24 >> octant & 1U) != 0) {
        mark_leaf(core::child_leaf(here, octant), level + 1U, child, node, octant);
      } else {
        add(child, level + 1U, node, octant);
      }
    }
  }

  void mark_leaf(std::uint32_t number, std::uint32_t level, core::Int3 cell, std::uint32_t node,
                 std::uint32_t octant) {
    const BuiltLeaf& leaf = tree_.leaves[number];
    std::uint32_t backed = 0;
    for (std::uint32_t k = leaf.first; k < leaf.first + leaf.count; ++k) {
      backed += interior_.is_backed(tree_.order[k]) ? 1U : 0U;
    }
    bytes_[node] |= static_cast<std::uint8_t>((2U * backed > leaf.count ? 1U : 0U) << octant);
    for (std::uint32_t eighth = 0; eighth < 8; ++eighth) {
      add(core::child_cell(cell, eighth), level + 1U, tree_.nodes.size() + number, eighth);
    }
  }

  const Interior& interior_;
  const Octree& tree_;
  std::vector<std::uint8_t> bytes_;
  std::vector<Cell> cells_;
};

}  // namespace

std::vector<std::uint8_t> interior_bytes(const Interior& interior, const Octree& tree) {
  if (interior.backed_share() == 0.0) {
    return {};
  }
  return Marker(interior, tree).run();
}

std::uint64_t interior_bytes_max(const Octree& tree) {
  constexpr std::uint64_t kAligned = 4;
  const std::uint64_t marks = tree.nodes.size() + tree.leaves.size();
  return sizeof(core::BlobExtension) + (marks + kAligned - 1) / kAligned * kAligned;
}

}  // namespace tactree::builder
