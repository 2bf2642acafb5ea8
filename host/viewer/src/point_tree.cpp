#include "tactree/viewer/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactree/support/blob_facts.hpp"

namespace tactree::viewer {
namespace {

using core::SurfacePoint;

std::vector<SurfacePoint> decode(const core::BlobView& view) {
  std::vector<SurfacePoint> points;
  points.reserve(view.point_count());
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    points.push_back(view.surface_point(leaf, index));
  });
  return points;
}

/// In the order of decode(); empty for a model with fewer than two materials.
std::vector<std::uint8_t> materials_of(const core::BlobView& view) {
  std::vector<std::uint8_t> materials;
  if (view.material_count() > 1) {
    core::for_each_point(view, [&](const core::Leaf&, std::uint32_t index) {
      materials.push_back(static_cast<std::uint8_t>(view.material_of(index)));
    });
  }
  return materials;
}

std::uint16_t to_share(float value, float low, float edge) {
  const float share = std::clamp((value - low) / edge, 0.0F, 1.0F);
  return static_cast<std::uint16_t>(std::lround(share * 65535.0F));
}

std::uint32_t to_byte(float value) {
  return static_cast<std::uint32_t>(std::lround((std::clamp(value, -1.0F, 1.0F) + 1.0F) * 127.5F));
}

/// Octahedral mapping of the unit sphere to a square, which has two coordinates.
std::uint16_t pack_normal(core::Vec3 n) {
  const float size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  float u = n.x / size;
  float v = n.y / size;
  if (n.z < 0.0F) {
    const float folded = (1.0F - std::abs(v)) * (u < 0.0F ? -1.0F : 1.0F);
    v = (1.0F - std::abs(u)) * (v < 0.0F ? -1.0F : 1.0F);
    u = folded;
  }
  return static_cast<std::uint16_t>(to_byte(u) << 8 | to_byte(v));
}

std::size_t octant_of(core::Vec3 p, const PointNode& node) {
  const float half = 0.5F * node.edge_m;
  return (p.x >= node.min_m[0] + half ? 1U : 0U) | (p.y >= node.min_m[1] + half ? 2U : 0U) |
         (p.z >= node.min_m[2] + half ? 4U : 0U);
}

PointNode root_of(const core::BlobView& view) {
  const core::BlobHeader& h = view.header();
  PointNode root;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    root.min_m[axis] = h.bounds_min_m[axis];
    root.edge_m = std::max(root.edge_m, h.bounds_max_m[axis] - h.bounds_min_m[axis]);
  }
  root.edge_m = std::max(root.edge_m, h.spacing_m);
  return root;
}

PointNode child_of(const PointNode& parent, std::size_t octant) {
  PointNode child;
  child.edge_m = 0.5F * parent.edge_m;
  child.min_m = parent.min_m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    child.min_m[axis] += (octant >> axis & 1U) != 0U ? child.edge_m : 0.0F;
  }
  return child;
}

}  // namespace

/// A node whose points have not been chosen yet.
struct PointTree::Task {
  std::uint32_t node = 0;
  std::uint32_t level = 0;
  std::vector<std::uint32_t> points;
};

class PointTree::Build {
 public:
  Build(PointTree& tree, const core::BlobView& view, std::span<const Rgb> colours)
      : tree_(tree),
        points_(decode(view)),
        materials_(materials_of(view)),
        colours_(colours),
        spacing_m_(view.header().spacing_m) {
    Task root;
    root.points.resize(points_.size());
    for (std::uint32_t i = 0; i < root.points.size(); ++i) {
      root.points[i] = i;
    }
    tree_.nodes_.push_back(root_of(view));
    tree_.points_.reserve(points_.size());
    open_.push_back(std::move(root));
  }

  // Breadth first, so that coarse nodes have the low numbers.
  void run() {
    for (std::size_t i = 0; i < open_.size(); ++i) {
      Task task = std::move(open_[i]);
      divide(task);
    }
  }

 private:
  /// Keeps every n-th point in the octree's order, which spreads the points evenly, and passes the
  /// rest to the children.
  void divide(Task& task) {
    const std::size_t all = task.points.size();
    const bool last = all <= kPointsPerNode || task.level == kMaxNodeLevel;
    const double stride = last ? 1.0 : static_cast<double>(all) / kPointsPerNode;
    PointNode& node = tree_.nodes_[task.node];
    node.first_point = static_cast<std::uint32_t>(tree_.points_.size());
    node.spacing_m = spacing_m_ * static_cast<float>(std::sqrt(stride));
    std::array<std::vector<std::uint32_t>, 8> below;
    double next = 0.0;
    for (std::size_t i = 0; i < all; ++i) {
      const std::uint32_t index = task.points[i];
      if (static_cast<double>(i) >= next) {
        keep(node, index);
        next += stride;
      } else {
        below[octant_of(points_[index].position, node)].push_back(index);
      }
    }
    node.point_count = static_cast<std::uint32_t>(tree_.points_.size()) - node.first_point;
    descend(task, below);
  }

  void keep(const PointNode& node, std::uint32_t index) {
    const SurfacePoint& point = points_[index];
    if (!materials_.empty()) {
      tree_.materials_.push_back(materials_[index]);
    }
    if (!colours_.empty()) {
      tree_.colours_.push_back(colours_[index]);
    }
    tree_.points_.push_back({to_share(point.position.x, node.min_m[0], node.edge_m),
                             to_share(point.position.y, node.min_m[1], node.edge_m),
                             to_share(point.position.z, node.min_m[2], node.edge_m),
                             pack_normal(point.normal)});
  }

  void descend(const Task& task, std::array<std::vector<std::uint32_t>, 8>& below) {
    for (std::size_t octant = 0; octant < below.size(); ++octant) {
      if (below[octant].empty()) {
        continue;
      }
      const auto number = static_cast<std::uint32_t>(tree_.nodes_.size());
      const PointNode child = child_of(tree_.nodes_[task.node], octant);
      tree_.nodes_.push_back(child);
      tree_.nodes_[task.node].children.push_back(number);
      open_.push_back({number, task.level + 1, std::move(below[octant])});
    }
  }

  PointTree& tree_;
  std::vector<SurfacePoint> points_;
  std::vector<std::uint8_t> materials_;
  std::span<const Rgb> colours_;
  float spacing_m_;
  std::vector<Task> open_;
};

PointTree::PointTree(const core::BlobView& view, std::span<const Rgb> colours) {
  Build(*this, view, colours).run();
}

std::span<const PackedPoint> PointTree::points(std::size_t node) const {
  return std::span(points_).subspan(nodes_[node].first_point, nodes_[node].point_count);
}

std::span<const std::uint8_t> PointTree::materials(std::size_t node) const {
  return materials_.empty()
             ? std::span<const std::uint8_t>()
             : std::span(materials_).subspan(nodes_[node].first_point, nodes_[node].point_count);
}

std::span<const Rgb> PointTree::colours(std::size_t node) const {
  return colours_.empty()
             ? std::span<const Rgb>()
             : std::span(colours_).subspan(nodes_[node].first_point, nodes_[node].point_count);
}

namespace {

nlohmann::json materials_json(const core::BlobView& view,
                              const std::vector<MaterialLabel>& labels) {
  const std::vector<std::uint32_t> points = support::points_of_materials(view);
  nlohmann::json list = nlohmann::json::array();
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    const core::BlobMaterial& m = view.material(i);
    nlohmann::json material = {{"points", points[i]},
                               {"stiffness_N_m", m.stiffness_N_m},
                               {"damping_Ns_m", m.damping_Ns_m},
                               {"static_friction", m.static_friction},
                               {"dynamic_friction", m.dynamic_friction},
                               {"texture_height_m", m.texture_height_m},
                               {"texture_wavelength_m", m.texture_wavelength_m}};
    if (i < labels.size()) {
      material["name"] = labels[i].name;
      if (labels[i].colour) {
        material["rgb"] = *labels[i].colour;
      }
    }
    list.push_back(std::move(material));
  }
  return list;
}

}  // namespace

std::string tree_json(const PointTree& tree, const core::BlobView& view, const ScanFacts& scan) {
  nlohmann::json colours = nlohmann::json::array();
  for (const ScanColour& colour : scan.colours) {
    colours.push_back({{"rgb", colour.rgb}, {"points", colour.points}});
  }
  nlohmann::json nodes = nlohmann::json::array();
  for (const PointNode& node : tree.nodes()) {
    nodes.push_back({{"min_m", node.min_m},
                     {"edge_m", node.edge_m},
                     {"spacing_m", node.spacing_m},
                     {"points", node.point_count},
                     {"children", node.children}});
  }
  const core::BlobHeader& h = view.header();
  const nlohmann::json tree_object = {{"name", h.name},
                                      {"points", h.point_count},
                                      {"spacing_m", h.spacing_m},
                                      {"depth", h.depth},
                                      {"bounds_min_m", std::to_array(h.bounds_min_m)},
                                      {"bounds_max_m", std::to_array(h.bounds_max_m)},
                                      {"materials", materials_json(view, scan.labels)},
                                      {"colours", colours},
                                      {"is_coloured", tree.has_colours()},
                                      {"nodes", nodes}};
  return tree_object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

namespace {

std::array<float, 3> lower_corner(const core::BlobView& view, core::Int3 site, float edge_m) {
  const float position[3] = {static_cast<float>(site.x), static_cast<float>(site.y),
                             static_cast<float>(site.z)};
  std::array<float, 3> corner{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float low = view.root_min_m()[axis];
    const float offset = position[axis] * view.step_m() - low;
    corner[axis] = low + edge_m * std::floor(offset / edge_m + 1e-3F);
  }
  return corner;
}

/// Cubes of one level; stops after `max_cubes` + 1 cubes.
OctantBoxes boxes_of_level(const core::BlobView& view, std::uint32_t level, std::size_t max_cubes) {
  OctantBoxes boxes;
  boxes.level = level;
  boxes.edge_m = view.leaf_edge_m() * static_cast<float>(1U << (view.depth() - level));
  // Leaves are stored in the octree's order, so that those of one cube are consecutive.
  for (core::LeafCursor cursor(view); !cursor.done() && boxes.corners_m.size() <= max_cubes;
       cursor.next()) {
    const std::array<float, 3> corner = lower_corner(view, cursor.leaf().min, boxes.edge_m);
    if (boxes.corners_m.empty() || boxes.corners_m.back() != corner) {
      boxes.corners_m.push_back(corner);
    }
  }
  return boxes;
}

}  // namespace

OctantBoxes octant_boxes(const core::BlobView& view, std::uint32_t level, std::size_t max_cubes) {
  for (std::uint32_t tried = std::min(level, view.depth()); tried > 0; --tried) {
    OctantBoxes boxes = boxes_of_level(view, tried, max_cubes);
    if (boxes.corners_m.size() <= max_cubes) {
      return boxes;
    }
  }
  return boxes_of_level(view, 0, std::numeric_limits<std::size_t>::max());
}

}  // namespace tactree::viewer
