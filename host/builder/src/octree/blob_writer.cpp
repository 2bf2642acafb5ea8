#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "octree/interior.hpp"
#include "octree/lattice.hpp"
#include "octree/octree_builder.hpp"
#include "octree/query_bound.hpp"
#include "octree/rounding.hpp"
#include "sampling/ball_bound.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/builder/version.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::builder {
namespace {

// Maximum reach of a query, in units. open_blob() requires a margin between the diameter of a query
// and the edge of a leaf.
constexpr double kReachUnits = core::kLeafUnits / 2 - 4;

// Distance over which errors of normals compensate each other: to the points beside and diagonally
// across on a grid, and well within the support of a fit.
constexpr double kDiffusionSpacings = 1.6;

Octree build_surface_octree(const Model& model, const Eigen::Vector3d& low,
                            const Eigen::Vector3d& high) {
  const double leaf_edge = model.reach_m * core::kLeafUnits / kReachUnits;
  return build_octree(model.positions, model.normals, choose_lattice(low, high, leaf_edge), 0);
}

std::uint32_t deepest(const Octree& tree) {
  std::uint32_t level = 0;
  for (const BuiltLeaf& leaf : tree.leaves) {
    level = std::max(level, leaf.level);
  }
  return level;
}

std::uint32_t fullest(const Octree& tree) {
  std::uint32_t count = 0;
  for (const BuiltLeaf& leaf : tree.leaves) {
    count = std::max(count, leaf.count);
  }
  return count;
}

// The tree of the `paper` profile: the smallest cubic root, split until no leaf holds more than m
// points. Leaves are at least half a spacing wide; points closer to each other than that stay in
// one leaf.
Octree build_paper_octree(const Model& model, Eigen::Vector3d low, Eigen::Vector3d high) {
  const Eigen::Vector3d middle = 0.5 * (low + high);
  low = low.cwiseMin(middle.array().matrix() - Eigen::Vector3d::Constant(model.spacing_m));
  high = high.cwiseMax(middle.array().matrix() + Eigen::Vector3d::Constant(model.spacing_m));
  const double extent = (high - low).maxCoeff();
  std::uint32_t depth = 1;
  while (depth < core::kMaxDepth &&
         std::ldexp(extent, -static_cast<int>(depth)) > model.spacing_m) {
    ++depth;
  }
  Octree tree = build_octree(model.positions, {}, bounding_lattice(low, high, depth),
                             model.points_per_leaf_wanted);
  // If no leaf needs the finest level, a coarser lattice gives the same leaves.
  for (std::uint32_t used = deepest(tree); used < depth; used = deepest(tree)) {
    depth = used;
    tree = build_octree(model.positions, {}, bounding_lattice(low, high, depth),
                        model.points_per_leaf_wanted);
  }
  return tree;
}

Eigen::Vector3d decode(const Octree& tree, const BuiltLeaf& leaf, std::uint32_t word) {
  const std::uint32_t scale = tree.lattice.depth - leaf.level;
  const auto axis = [&](std::int32_t low, std::uint32_t site) {
    return tree.lattice.step_m * (low + static_cast<std::int32_t>((2U * site + 1U) << scale));
  };
  return {axis(leaf.min.x, (word >> 2) & 1023U), axis(leaf.min.y, (word >> 12) & 1023U),
          axis(leaf.min.z, word >> 22)};
}

std::vector<Eigen::Vector3d> decode_all(const Octree& tree) {
  std::vector<Eigen::Vector3d> decoded;
  decoded.reserve(tree.order.size());
  for (const BuiltLeaf& leaf : tree.leaves) {
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      decoded.push_back(decode(tree, leaf, tree.words[leaf.first + i]));
    }
  }
  return decoded;
}

// The deepest level whose directory takes at most 1/32 of the memory of the point words, or that
// leaves no more levels below it than a query can traverse.
std::uint32_t directory_level(const Octree& tree) {
  const std::uint32_t depth = tree.lattice.depth;
  std::uint32_t level = depth > core::kMaxLevelsBelow ? depth - core::kMaxLevelsBelow : 0U;
  while (level + 1U < depth && std::size_t{32} << 3U * (level + 1U) <= tree.words.size()) {
    ++level;
  }
  return level;
}

// The nodes of a level, indexed by cell; empty for level 0, the root.
std::vector<std::uint32_t> directory(const Octree& tree, std::uint32_t level) {
  std::vector<std::uint32_t> entries;
  if (level == 0) {
    return entries;
  }
  entries.assign(std::size_t{1} << 3U * level, core::kNoNode);
  const auto fill = [&](const auto& self, std::uint32_t node, std::uint32_t above,
                        core::Int3 cell) -> void {
    if (above == level) {
      entries[static_cast<std::size_t>(cell.x) | static_cast<std::size_t>(cell.y) << level |
              static_cast<std::size_t>(cell.z) << 2U * level] = node;
      return;
    }
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      if ((tree.nodes[node].nodes >> 24 >> octant & 1U) != 0) {
        self(self, core::child_node(tree.nodes[node], octant), above + 1U,
             core::child_cell(cell, octant));
      }
    }
  };
  fill(fill, 0, 0, {});
  return entries;
}

// The maximum shift of the leaf group size at which 16 bits can count the points from the first
// leaf of a group.
std::uint32_t leaf_group_shift(const std::vector<std::uint32_t>& first_points) {
  std::uint32_t shift = core::kMaxLeafGroupShift;
  const auto fits = [&] {
    const std::size_t in_group = (std::size_t{1} << shift) - 1U;
    for (std::size_t i = 0; i < first_points.size(); ++i) {
      if (first_points[i] - first_points[i & ~in_group] > 0xFFFFU) {
        return false;
      }
    }
    return true;
  };
  while (!fits()) {
    --shift;
  }
  return shift;
}

class Serialiser {
 public:
  core::BlobSection append(const void* data, std::size_t bytes) {
    const core::BlobSection section{static_cast<std::uint32_t>(bytes_.size()),
                                    static_cast<std::uint32_t>(bytes)};
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + bytes);
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return section;
  }
  template <typename T>
  core::BlobSection append(const std::vector<T>& items) {
    return append(items.data(), items.size() * sizeof(T));
  }
  std::vector<std::byte>& bytes() { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

core::BlobDouble to_words(double v) {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

// Truncates between two characters, so that UTF-8 stays valid.
void copy_text(char* field, std::size_t size, const std::string& text) {
  std::size_t length = std::min(text.size(), size - 1);
  while (length > 0 && length < text.size() &&
         (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) {
    --length;
  }
  length = std::min(length, std::strlen(text.c_str()));
  std::copy_n(text.data(), length, field);
}

void set_bounds(core::BlobHeader& header, const std::vector<Eigen::Vector3d>& decoded) {
  Eigen::Vector3d low = decoded.front();
  Eigen::Vector3d high = decoded.front();
  for (const Eigen::Vector3d& p : decoded) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int axis = 0; axis < 3; ++axis) {
    header.bounds_min_m[axis] = static_cast<float>(low[axis]);
    header.bounds_max_m[axis] = static_cast<float>(high[axis]);
  }
}

void set_lengths(core::BlobHeader& header, const Model& model, const Lattice& lattice) {
  const auto step = static_cast<float>(lattice.step_m);
  const bool surface = model.profile == core::Profile::kSurface;
  const float reach_limit = step * static_cast<float>(kReachUnits);
  header.step_m = step;
  header.root_min[0] = lattice.root_min.x;
  header.root_min[1] = lattice.root_min.y;
  header.root_min[2] = lattice.root_min.z;
  header.depth = lattice.depth;
  header.spacing_m = std::max(static_cast<float>(model.spacing_m), step);
  header.support_radius_m = static_cast<float>(model.support_radius_m);
  header.reach_m =
      surface ? static_cast<float>(model.reach_m)
              : std::min(static_cast<float>(std::max(model.reach_m, model.spacing_m)), reach_limit);
  header.leaf_edge_min_m = step * static_cast<float>(core::kLeafUnits);
  header.aabb_edge_m = static_cast<float>(model.spacing_m);
  header.six_point_offset_m = static_cast<float>(model.spacing_m);
  header.largest_gap_m = static_cast<float>(model.largest_gap_m);
}

// Maximum points in the support of a fit, which gathers no point beyond the reach; 0 without one.
std::uint32_t support_bound(const core::BlobHeader& header,
                            const std::vector<Eigen::Vector3d>& decoded) {
  const auto radius = static_cast<double>(header.support_radius_m);
  return radius > 0.0
             ? std::clamp(max_points_in_ball(decoded, radius), 1U, header.points_per_ball_max)
             : 0U;
}

core::BlobHeader make_header(const Model& model, const Octree& tree) {
  core::BlobHeader header{};
  std::memcpy(header.magic, core::kBlobMagic, sizeof header.magic);
  header.version_major = core::kBlobMajor;
  header.version_minor = core::kBlobMinor;
  header.header_bytes = sizeof header;
  header.profile = static_cast<std::uint32_t>(model.profile);
  set_lengths(header, model, tree.lattice);
  const std::vector<Eigen::Vector3d> decoded = decode_all(tree);
  set_bounds(header, decoded);
  header.point_count = static_cast<std::uint32_t>(decoded.size());
  header.leaf_count = static_cast<std::uint32_t>(tree.leaves.size());
  header.node_count = static_cast<std::uint32_t>(tree.nodes.size());
  header.material_count = static_cast<std::uint32_t>(model.materials.size());
  header.points_per_leaf_max = fullest(tree);
  const QueryBound query = query_bound(tree, model.profile, static_cast<double>(header.reach_m));
  header.points_per_query_max = query.points;
  header.points_per_slab_max = query.points_per_slab;
  // A ball of this radius touches only leaves of its query, so their points are another bound.
  header.points_per_ball_max =
      std::min(header.points_per_query_max,
               std::max(1U, max_points_in_ball(decoded, static_cast<double>(header.reach_m))));
  header.points_per_support_max = support_bound(header, decoded);
  header.leaves_per_query_max = core::kLeavesPerQuery;
  header.source_scale = to_words(model.source_scale);
  for (int axis = 0; axis < 3; ++axis) {
    header.source_origin[axis] = to_words(model.source_origin[axis]);
  }
  copy_text(header.name, sizeof header.name, model.name);
  std::copy(model.source_digest.begin(), model.source_digest.end(), header.source_digest);
  copy_text(header.tool_version, sizeof header.tool_version, kToolVersion);
  return header;
}

// In the surface profile each node has children of one kind only, so one of its two words is 0.
void append_nodes(Serialiser& out, core::BlobHeader& header, core::Profile profile,
                  const Octree& tree) {
  if (profile == core::Profile::kPaper) {
    header.nodes = out.append(tree.nodes);
    header.directory = out.append(std::vector<std::uint32_t>{});
    return;
  }
  std::vector<std::uint32_t> groups;
  groups.reserve(tree.nodes.size());
  for (const core::BlobNode& node : tree.nodes) {
    groups.push_back(node.nodes | node.leaves);
  }
  header.nodes = out.append(groups);
  header.directory_level = directory_level(tree);
  header.directory = out.append(directory(tree, header.directory_level));
}

void append_leaves(Serialiser& out, core::BlobHeader& header, const Octree& tree) {
  std::vector<std::uint32_t> first_points;
  for (const BuiltLeaf& leaf : tree.leaves) {
    first_points.push_back(leaf.first);
  }
  first_points.push_back(header.point_count);
  header.leaf_group_shift = leaf_group_shift(first_points);
  std::vector<std::uint32_t> bases;
  std::vector<std::uint16_t> offsets;
  for (std::size_t i = 0; i < first_points.size(); ++i) {
    if (i >> header.leaf_group_shift == bases.size()) {
      bases.push_back(first_points[i]);
    }
    offsets.push_back(static_cast<std::uint16_t>(first_points[i] - bases.back()));
  }
  header.leaf_bases = out.append(bases);
  header.leaf_offsets = out.append(offsets);
}

// The codes of the points of a leaf depend on each other.
std::vector<std::uint32_t> normal_codes(const Model& model, const Octree& tree) {
  const double radius =
      model.profile == core::Profile::kSurface ? kDiffusionSpacings * model.spacing_m : 0.0;
  std::vector<std::uint32_t> codes(tree.order.size());
  const auto encode = [&](std::size_t number) {
    const BuiltLeaf& leaf = tree.leaves[number];
    std::vector<Eigen::Vector3d> positions(leaf.count);
    std::vector<Eigen::Vector3f> normals(leaf.count);
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      positions[i] = decode(tree, leaf, tree.words[leaf.first + i]);
      normals[i] = model.normals[tree.order[leaf.first + i]];
    }
    encode_normals(positions, normals, radius, std::span(codes).subspan(leaf.first, leaf.count));
  };
  tbb::parallel_for(std::size_t{0}, tree.leaves.size(), encode);
  return codes;
}

void append_points(Serialiser& out, core::BlobHeader& header, const Model& model,
                   const Octree& tree) {
  const std::vector<std::uint32_t> codes = normal_codes(model, tree);
  std::vector<std::uint32_t> words = tree.words;
  std::vector<std::uint16_t> normals(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] |= codes[i] >> 16;
    normals[i] = static_cast<std::uint16_t>(codes[i]);
  }
  header.points = out.append(words);
  header.normals = out.append(normals);
}

void append_materials(Serialiser& out, core::BlobHeader& header, const Model& model,
                      const Octree& tree) {
  header.materials = out.append(model.materials);
  std::vector<std::uint8_t> indices;
  if (model.materials.size() > 1) {
    for (const std::uint32_t source : tree.order) {
      indices.push_back(model.material_indices[source]);
    }
  }
  header.material_indices = out.append(indices);
}

/// Writes an extension of the header, which a reader of version 1.0 skips.
void append_interior(Serialiser& out, core::BlobHeader& header,
                     const std::vector<std::uint8_t>& interior) {
  if (interior.empty()) {
    return;
  }
  const core::BlobExtension extension{
      {sizeof header + sizeof(core::BlobExtension), static_cast<std::uint32_t>(interior.size())}};
  out.append(&extension, sizeof extension);
  out.append(interior);
  header.header_bytes = static_cast<std::uint32_t>(out.bytes().size());
}

std::vector<std::byte> serialise(const Model& model, const Octree& tree,
                                 const std::vector<std::uint8_t>& interior) {
  core::BlobHeader header = make_header(model, tree);
  Serialiser out;
  out.append(&header, sizeof header);
  append_interior(out, header, interior);
  append_nodes(out, header, model.profile, tree);
  append_leaves(out, header, tree);
  append_points(out, header, model, tree);
  const bool paper = model.profile == core::Profile::kPaper;
  header.neighbours = out.append(paper ? neighbour_table(tree) : std::vector<std::uint32_t>{});
  append_materials(out, header, model, tree);
  if (out.bytes().size() > 0xFFFFFFFFU || header.leaf_count > core::kMaxLeaves ||
      header.node_count > core::kMaxNodes) {
    throw std::runtime_error(
        "the model is too large for a blob (choose a larger spacing, or crop it)");
  }
  header.total_bytes = static_cast<std::uint32_t>(out.bytes().size());
  std::memcpy(out.bytes().data(), &header, sizeof header);
  seal(out.bytes());
  return std::move(out.bytes());
}

void check_model(const Model& model) {
  if (model.positions.empty()) {
    throw std::runtime_error("the model has no points");
  }
  if (model.normals.size() != model.positions.size()) {
    throw std::invalid_argument("write_blob: the number of normals differs from that of positions");
  }
  if (model.materials.size() > 1 && model.material_indices.size() != model.positions.size()) {
    throw std::invalid_argument(
        "write_blob: the number of material indices differs from that of positions");
  }
  if (!model.doubtful.empty() && model.doubtful.size() != model.positions.size()) {
    throw std::invalid_argument(
        "write_blob: the number of orientation flags differs from that of positions");
  }
  if (!(model.spacing_m > 0.0) || !(model.reach_m >= 0.0)) {
    throw std::invalid_argument("write_blob: the spacing must be positive");
  }
}

}  // namespace

void seal(std::span<std::byte> blob) {
  constexpr std::size_t kAt = offsetof(core::BlobHeader, checksum);
  core::Crc32 crc;
  crc.update(blob.first(kAt));
  crc.update(blob.subspan(kAt + sizeof(std::uint32_t)));
  const std::uint32_t value = crc.value();
  std::memcpy(blob.data() + kAt, &value, sizeof value);
}

WrittenBlob write_blob(const Model& model) {
  check_model(model);
  Eigen::Vector3d low = model.positions.front();
  Eigen::Vector3d high = model.positions.front();
  for (const Eigen::Vector3d& p : model.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const bool paper = model.profile == core::Profile::kPaper;
  const Octree tree =
      paper ? build_paper_octree(model, low, high) : build_surface_octree(model, low, high);
  WrittenBlob written;
  std::vector<std::uint8_t> interior;
  if (model.tells_interior && !paper) {
    const Interior found({model.positions, model.normals, model.doubtful, model.spacing_m});
    interior = interior_bytes(found, tree);
    written.backed_share = found.backed_share();
  }
  written.interior_bytes_max = paper ? 0 : interior_bytes_max(tree);
  written.bytes = serialise(model, tree, interior);
  written.source_index = tree.order;
  written.merged = tree.merged;
  core::BlobView view;
  const core::BlobStatus status = core::open_blob(written.bytes, view);
  if (status != core::BlobStatus::kOk) {
    throw std::logic_error(
        fmt::format("the blob just written fails its own check: {}", core::describe(status)));
  }
  return written;
}

}  // namespace tactree::builder
