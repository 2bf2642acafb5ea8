// Validation of a blob, and access to its leaves and points.
// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/model/blob.hpp"

#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/octree.hpp"

namespace tactree::core {
namespace {

constexpr std::size_t kHeaderBytes = sizeof(BlobHeader);
// The directory of a blob that stores none: the root.
constexpr std::uint32_t kRootNode = 0;

constexpr std::size_t kChecksumEnd = offsetof(BlobHeader, checksum) + sizeof(std::uint32_t);

std::uint32_t checksum_of(std::span<const std::byte> bytes) {
  Crc32 crc;
  crc.update(bytes.first(offsetof(BlobHeader, checksum)));
  crc.update(bytes.subspan(kChecksumEnd));
  return crc.value();
}

bool is_terminated(const char* text, std::uint32_t size) {
  bool ended = false;
  for (std::uint32_t i = 0; i < size; ++i) {  // bound: 32
    if (text[i] == 0) {
      ended = true;
    } else if (ended) {
      return false;
    }
  }
  return ended;
}

// Returns false for NaN and infinity.
bool in_range(float v, float low, float high) { return v >= low && v <= high; }

// Significant bits of a positive normal float: 1 for a power of two, at most 24.
std::uint32_t significant_bits(float v) {
  std::uint32_t fraction = (std::bit_cast<std::uint32_t>(v) & 0x7FFFFFU) | 0x800000U;
  std::uint32_t bits = 24;
  while ((fraction & 1U) == 0) {  // bound: 23
    fraction >>= 1;
    --bits;
  }
  return bits;
}

}  // namespace

// Each check may rely on those that run before it.
class BlobValidator {
 public:
  BlobValidator(std::span<const std::byte> bytes, BlobView& view) : bytes_(bytes), view_(view) {}

  BlobStatus run() {
    BlobStatus status = check_envelope();
    if (status == BlobStatus::kOk && !header_is_sane()) status = BlobStatus::kBadHeader;
    if (status == BlobStatus::kOk && !figures_are_sane()) status = BlobStatus::kBadFigures;
    if (status == BlobStatus::kOk && !(sections_tile() && interior_fits()))
      status = BlobStatus::kBadSections;
    if (status != BlobStatus::kOk) return status;
    attach();
    if (!leaves_are_sane()) return BlobStatus::kBadLeaves;
    if (!tree_is_canonical() || !directory_lists_nodes()) return BlobStatus::kBadTree;
    if (!points_ascend()) return BlobStatus::kBadPoints;
    if (!neighbours_exist()) return BlobStatus::kBadNeighbours;
    if (!materials_are_sane()) return BlobStatus::kBadMaterials;
    return BlobStatus::kOk;
  }

 private:
  BlobStatus check_envelope() {
    if ((reinterpret_cast<std::uintptr_t>(bytes_.data()) & 3U) != 0) return BlobStatus::kMisaligned;
    if (bytes_.size() < kHeaderBytes) return BlobStatus::kTooShort;
    header_ = reinterpret_cast<const BlobHeader*>(bytes_.data());
    for (std::uint32_t i = 0; i < sizeof kBlobMagic; ++i) {  // bound: 8
      if (header_->magic[i] != kBlobMagic[i]) return BlobStatus::kBadMagic;
    }
    if (header_->version_major != kBlobMajor) return BlobStatus::kBadVersion;
    if (header_->total_bytes != bytes_.size()) return BlobStatus::kBadSize;
    if (header_->checksum != checksum_of(bytes_)) return BlobStatus::kBadChecksum;
    return BlobStatus::kOk;
  }

  bool header_is_sane() const {
    const BlobHeader& h = *header_;
    if (h.header_bytes < kHeaderBytes || h.header_bytes > h.total_bytes) return false;
    if ((h.header_bytes & 3U) != 0) return false;
    if (h.profile > static_cast<std::uint32_t>(Profile::kPaper)) return false;
    if (h.depth < 1 || h.depth > kMaxDepth) return false;
    if (!counts_are_sane()) return false;
    if (h.leaves_per_query_max != kLeavesPerQuery) return false;
    if (h.leaf_group_shift > kMaxLeafGroupShift || !directory_level_is_sane()) return false;
    for (const std::uint32_t word : h.reserved) {  // bound: 3
      if (word != 0) return false;
    }
    return is_terminated(h.name, sizeof h.name) &&
           is_terminated(h.tool_version, sizeof h.tool_version);
  }

  bool counts_are_sane() const {
    const BlobHeader& h = *header_;
    if (h.point_count == 0 || h.leaf_count == 0 || h.node_count == 0) return false;
    if (h.leaf_count > kMaxLeaves || h.node_count > kMaxNodes) return false;
    if (h.leaf_count > h.point_count || h.material_count > kMaxMaterials) return false;
    if (h.points_per_leaf_max == 0 || h.points_per_leaf_max > h.point_count) return false;
    if (h.points_per_ball_max == 0 || h.points_per_ball_max > h.point_count) return false;
    if (h.points_per_support_max > h.points_per_ball_max) return false;
    if (h.points_per_query_max < h.points_per_leaf_max) return false;
    if (h.points_per_query_max > h.point_count) return false;
    return h.points_per_slab_max != 0 && h.points_per_slab_max <= h.points_per_query_max;
  }

  [[nodiscard]] bool is_surface() const {
    return header_->profile == static_cast<std::uint32_t>(Profile::kSurface);
  }

  bool directory_level_is_sane() const {
    const std::uint32_t level = header_->directory_level;
    if (!is_surface()) return level == 0;
    return level < header_->depth && header_->depth - level <= kMaxLevelsBelow;
  }

  bool figures_are_sane() const {
    const BlobHeader& h = *header_;
    if (!in_range(h.step_m, 1e-12F, 1e6F)) return false;
    const std::int32_t edge = kLeafUnits << h.depth;
    std::int32_t largest = 1;
    for (const std::int32_t low : h.root_min) {  // bound: 3
      if (low < -kMaxCoordinate || low > kMaxCoordinate - edge) return false;
      if (-low > largest) largest = -low;
      if (low + edge > largest) largest = low + edge;
    }
    // step * integer must be exact: see blob_format.hpp.
    if (largest > 1 << (24U - significant_bits(h.step_m))) return false;
    return lengths_are_sane() && bounds_are_sane();
  }

  bool lengths_are_sane() const {
    const BlobHeader& h = *header_;
    const float leaf_edge = h.step_m * static_cast<float>(kLeafUnits);
    if (h.leaf_edge_min_m != leaf_edge) return false;
    if (!in_range(h.spacing_m, h.step_m, 1e9F)) return false;
    if (!in_range(h.support_radius_m, 0.0F, 1e9F)) return false;
    if (!in_range(h.aabb_edge_m, 0.0F, 1e9F)) return false;
    if (!in_range(h.six_point_offset_m, 0.0F, 1e9F)) return false;
    if (!in_range(h.largest_gap_m, 0.0F, 1e9F)) return false;
    // Eight-corner rule: a query cube must not be longer than a leaf. The 4 units allow for the
    // rounding in CornerLeaves.
    const float reach_max = h.step_m * static_cast<float>(kLeafUnits / 2 - 4);
    if (!in_range(h.reach_m, 0.0F, reach_max)) return false;
    return !is_surface() || (h.support_radius_m > 0.0F && h.support_radius_m <= h.reach_m &&
                             0.5F * h.aabb_edge_m <= h.reach_m);
  }

  bool bounds_are_sane() const {
    const BlobHeader& h = *header_;
    const std::int32_t edge = kLeafUnits << h.depth;
    for (std::uint32_t i = 0; i < 3; ++i) {  // bound: 3
      const float low = h.step_m * static_cast<float>(h.root_min[i]);
      const float high = h.step_m * static_cast<float>(h.root_min[i] + edge);
      if (!in_range(h.bounds_min_m[i], low, high)) return false;
      if (!in_range(h.bounds_max_m[i], h.bounds_min_m[i], high)) return false;
    }
    return true;
  }

  // Checks that a section begins at cursor_, and moves cursor_ past its padding. With 64 bits,
  // sums of untrusted counts do not wrap.
  bool take(const BlobSection& section, std::uint64_t expected_bytes) {
    if (section.offset != cursor_ || section.bytes != expected_bytes) return false;
    const std::uint64_t padding_begin = cursor_ + section.bytes;
    cursor_ = (padding_begin + 3U) & ~std::uint64_t{3};
    if (cursor_ > header_->total_bytes) return false;
    for (std::uint64_t i = padding_begin; i < cursor_; ++i) {  // bound: 3
      if (bytes_[static_cast<std::size_t>(i)] != std::byte{0}) return false;
    }
    return true;
  }

  bool sections_tile() {
    const BlobHeader& h = *header_;
    cursor_ = h.header_bytes;
    const std::uint64_t neighbour_bytes = h.neighbours.bytes == 0 ? 0 : 24ULL * h.leaf_count;
    const std::uint64_t index_bytes = h.material_count > 1 ? h.point_count : 0;
    const std::uint64_t node_bytes = is_surface() ? sizeof(std::uint32_t) : sizeof(BlobNode);
    const std::uint64_t directory_bytes =
        h.directory_level == 0 ? 0 : 4ULL * (1U << 3U * h.directory_level);
    const std::uint64_t leaf_groups = (h.leaf_count >> h.leaf_group_shift) + 1ULL;
    return take(h.nodes, node_bytes * h.node_count) && take(h.directory, directory_bytes) &&
           take(h.leaf_bases, 4ULL * leaf_groups) &&
           take(h.leaf_offsets, 2ULL * (std::uint64_t{h.leaf_count} + 1U)) &&
           take(h.points, 4ULL * h.point_count) && take(h.normals, 2ULL * h.point_count) &&
           take(h.neighbours, neighbour_bytes) &&
           take(h.materials, sizeof(BlobMaterial) * std::uint64_t{h.material_count}) &&
           take(h.material_indices, index_bytes) && cursor_ == h.total_bytes;
  }

  // The interior must lie within header_bytes, after the extension.
  bool interior_fits() {
    const BlobHeader& h = *header_;
    constexpr std::uint32_t kBegin = kHeaderBytes + sizeof(BlobExtension);
    if (h.version_minor < 1 || h.header_bytes < kBegin) return true;
    interior_ = &reinterpret_cast<const BlobExtension*>(bytes_.data() + kHeaderBytes)->interior;
    if (interior_->bytes == 0) return interior_->offset == 0;
    const std::uint64_t end = std::uint64_t{interior_->offset} + interior_->bytes;
    return is_surface() && interior_->offset >= kBegin && end <= h.header_bytes &&
           interior_->bytes == std::uint64_t{h.node_count} + h.leaf_count;
  }

  template <typename T>
  const T* at(const BlobSection& section) const {
    if (section.bytes == 0) return nullptr;
    return reinterpret_cast<const T*>(bytes_.data() + section.offset);
  }

  void attach() {
    const BlobHeader& h = *header_;
    view_.header_ = header_;
    view_.nodes_ = at<std::uint32_t>(h.nodes);
    view_.directory_ = h.directory_level == 0 ? &kRootNode : at<std::uint32_t>(h.directory);
    view_.leaf_bases_ = at<std::uint32_t>(h.leaf_bases);
    view_.leaf_offsets_ = at<std::uint16_t>(h.leaf_offsets);
    view_.points_ = at<std::uint32_t>(h.points);
    view_.normals_ = at<std::uint16_t>(h.normals);
    view_.neighbours_ = at<std::uint32_t>(h.neighbours);
    view_.materials_ = at<BlobMaterial>(h.materials);
    view_.material_indices_ = at<std::uint8_t>(h.material_indices);
    view_.interior_ = interior_ == nullptr ? nullptr : at<std::uint8_t>(*interior_);
    view_.step_m_ = h.step_m;
    view_.inverse_step_ = 1.0F / h.step_m;
    view_.reach_m_ = h.reach_m;
    view_.support_radius_m_ = h.support_radius_m;
    view_.leaf_edge_m_ = h.leaf_edge_min_m;
    view_.inverse_leaf_edge_ = 1.0F / h.leaf_edge_min_m;
    view_.cells_and_one_ = static_cast<float>((1U << h.depth) + 1U);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {  // bound: 3
      view_.root_min_m_[axis] = h.step_m * static_cast<float>(h.root_min[axis]);
    }
    view_.root_min_ = {h.root_min[0], h.root_min[1], h.root_min[2]};
    view_.node_count_ = h.node_count;
    view_.leaf_count_ = h.leaf_count;
    view_.point_count_ = h.point_count;
    view_.depth_ = static_cast<std::uint8_t>(h.depth);
    view_.directory_level_ = static_cast<std::uint8_t>(h.directory_level);
    view_.leaf_group_shift_ = static_cast<std::uint8_t>(h.leaf_group_shift);
    view_.material_count_ = static_cast<std::uint8_t>(h.material_count);
    view_.uniform_ = is_surface();
  }

  bool leaves_are_sane() const {
    const std::uint32_t in_group = (1U << header_->leaf_group_shift) - 1U;
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < header_->leaf_count; ++i) {  // bound: leaves
      if (view_.first_point(i) != first) return false;
      if ((i & in_group) == 0 && view_.leaf_offsets_[i] != 0) return false;
      const std::uint32_t next = view_.first_point(i + 1);
      if (next <= first || next - first > header_->points_per_leaf_max) return false;
      first = next;
    }
    const bool last_begins_group = (header_->leaf_count & in_group) == 0;
    return first == header_->point_count &&
           !(last_begins_group && view_.leaf_offsets_[header_->leaf_count] != 0);
  }

  // Depth-first traversal. Each group of children must start at the next index not yet used. Then
  // every node except the root has exactly one parent, which precedes it, and the leaves are
  // numbered in the order of the traversal.
  bool tree_is_canonical() const {
    struct Frame {
      std::uint32_t node;
      std::uint32_t octants_left;
    };
    Frame stack[kMaxDepth];
    TreeCounts seen;
    if (!open_node(0, 0, seen)) return false;
    stack[0] = {0, view_.node(0, 0).nodes >> 24};
    std::uint32_t level = 0;
    while (true) {  // bound: 2 * nodes (each is entered once and left once)
      Frame& frame = stack[level];
      if (frame.octants_left == 0) {
        if (level == 0) break;
        --level;
        continue;
      }
      if (level + 1 >= header_->depth) return false;
      const std::uint32_t octant = lowest_octant(frame.octants_left);
      frame.octants_left &= frame.octants_left - 1U;
      const std::uint32_t child = child_node(view_.node(frame.node, level), octant);
      ++level;
      if (!open_node(child, level, seen)) return false;
      stack[level] = {child, view_.node(child, level).nodes >> 24};
    }
    return seen.nodes == header_->node_count && seen.leaves == header_->leaf_count &&
           seen.depth == header_->depth;
  }

  struct TreeCounts {
    std::uint32_t nodes = 1;
    std::uint32_t leaves = 0;
    std::uint32_t depth = 0;
  };

  bool open_node(std::uint32_t index, std::uint32_t level, TreeCounts& seen) const {
    const BlobNode node = view_.node(index, level);
    const std::uint32_t node_mask = node.nodes >> 24;
    const std::uint32_t leaf_mask = node.leaves >> 24;
    if ((node_mask & leaf_mask) != 0 || (node_mask | leaf_mask) == 0) return false;
    if (view_.interior_ != nullptr && (view_.interior_[index] & node_mask) != 0) return false;
    if (!take_group(node.nodes, header_->node_count, seen.nodes)) return false;
    if (!take_group(node.leaves, header_->leaf_count, seen.leaves)) return false;
    if (leaf_mask != 0 && level + 1 > seen.depth) seen.depth = level + 1;
    return true;
  }

  // Compares each entry with a descent from the root, which uses only the lowest `level` bits of
  // each coordinate.
  bool directory_lists_nodes() const {
    const std::uint32_t level = header_->directory_level;
    const std::uint32_t entries = 1U << 3U * level;
    for (std::uint32_t i = 0; i < entries; ++i) {  // bound: directory_entries
      const Int3 cell{static_cast<std::int32_t>(i), static_cast<std::int32_t>(i >> level),
                      static_cast<std::int32_t>(i >> 2U * level)};
      if (view_.directory_[i] != node_of_cell(cell, level)) return false;
    }
    return true;
  }

  std::uint32_t node_of_cell(Int3 cell, std::uint32_t level) const {
    std::uint32_t node = 0;
    for (std::uint32_t above = 0; above < level; ++above) {  // bound: depth
      const std::uint32_t shift = level - above - 1U;
      const std::uint32_t octant = (static_cast<std::uint32_t>(cell.x) >> shift & 1U) |
                                   (static_cast<std::uint32_t>(cell.y) >> shift & 1U) << 1 |
                                   (static_cast<std::uint32_t>(cell.z) >> shift & 1U) << 2;
      const BlobNode here = view_.node(node, above);
      if ((here.nodes >> 24 >> octant & 1U) == 0) return kNoNode;
      node = child_node(here, octant);
    }
    return node;
  }

  // A group must begin at `next` and end at or below `limit`; an empty group must be 0.
  static bool take_group(std::uint32_t group, std::uint32_t limit, std::uint32_t& next) {
    const std::uint32_t children = count_octants(group >> 24);
    if (children == 0) return group == 0;
    if ((group & 0xFFFFFFU) != next || children > limit - next) return false;
    next += children;
    return true;
  }

  bool points_ascend() const {
    for (std::uint32_t i = 0; i < header_->leaf_count; ++i) {  // bound: leaves
      std::uint32_t p = view_.first_point(i);
      const std::uint32_t end = view_.first_point(i + 1);
      std::uint32_t previous = view_.points_[p] & kPointPositionMask;
      for (++p; p < end; ++p) {  // bound: points_per_leaf_max
        const std::uint32_t here = view_.points_[p] & kPointPositionMask;
        if (here <= previous) return false;
        previous = here;
      }
    }
    return true;
  }

  bool neighbours_exist() const {
    if (!view_.has_neighbours()) return true;
    for (std::uint32_t i = 0; i < 6U * header_->leaf_count; ++i) {  // bound: 6 * leaves
      const std::uint32_t entry = view_.neighbours_[i];
      if (entry == kNeighbourNone) continue;
      const bool is_node = (entry & kNeighbourIsNode) != 0;
      const std::uint32_t level = (entry & ~kNeighbourIsNode) >> kNeighbourLevelShift;
      if (level > header_->depth || (is_node && level == header_->depth)) return false;
      const std::uint32_t limit = is_node ? header_->node_count : header_->leaf_count;
      if ((entry & kNeighbourIndexMask) >= limit) return false;
    }
    return true;
  }

  bool materials_are_sane() const {
    for (std::uint32_t i = 0; i < header_->material_count; ++i) {  // bound: 255
      const BlobMaterial& m = view_.materials_[i];
      if (!in_range(m.stiffness_N_m, 0.0F, 1e6F) || !in_range(m.damping_Ns_m, 0.0F, 1e4F)) {
        return false;
      }
      if (!in_range(m.static_friction, 0.0F, 4.0F)) return false;
      if (!in_range(m.dynamic_friction, 0.0F, m.static_friction)) return false;
      if (!in_range(m.texture_height_m, 0.0F, 1.0F)) return false;
      if (!in_range(m.texture_wavelength_m, 0.0F, 1e3F)) return false;
      if (m.reserved[0] != 0 || m.reserved[1] != 0) return false;
    }
    if (header_->material_count <= 1) return true;
    for (std::uint32_t i = 0; i < header_->point_count; ++i) {  // bound: points
      if (view_.material_indices_[i] >= header_->material_count) return false;
    }
    return true;
  }

  std::span<const std::byte> bytes_;
  BlobView& view_;
  const BlobHeader* header_ = nullptr;
  const BlobSection* interior_ = nullptr;  // in the header's extension, if present
  std::uint64_t cursor_ = 0;               // end of the sections checked so far
};

BlobStatus open_blob(std::span<const std::byte> bytes, BlobView& view) {
  view = BlobView{};
  const BlobStatus status = BlobValidator(bytes, view).run();
  if (status != BlobStatus::kOk) {
    view = BlobView{};
  }
  return status;
}

const char* describe(BlobStatus status) {
  switch (status) {
    case BlobStatus::kOk:
      return "valid";
    case BlobStatus::kMisaligned:
      return "the bytes do not start on a 4-byte boundary";
    case BlobStatus::kTooShort:
      return "shorter than a blob's header";
    case BlobStatus::kBadMagic:
      return "not a Tactree blob";
    case BlobStatus::kBadVersion:
      return "made for another major version of Tactree";
    case BlobStatus::kBadSize:
      return "truncated, or bytes were appended";
    case BlobStatus::kBadChecksum:
      return "damaged: the checksum does not match";
    case BlobStatus::kBadHeader:
      return "the header holds an invalid count, text or reserved field";
    case BlobStatus::kBadFigures:
      return "the header's lengths contradict each other";
    case BlobStatus::kBadSections:
      return "the sections do not tile the blob";
    case BlobStatus::kBadTree:
      return "the octree is not well-formed";
    case BlobStatus::kBadLeaves:
      return "a leaf is empty, too full or out of order";
    case BlobStatus::kBadPoints:
      return "the points of a leaf are out of order";
    case BlobStatus::kBadNeighbours:
      return "the neighbour table names a cell that does not exist";
    case BlobStatus::kBadMaterials:
      return "a material is invalid or missing";
  }
  return "unknown status";
}

Vec3 BlobView::position(const Leaf& leaf, std::uint32_t index) const {
  const std::uint32_t word = points_[index];
  const std::uint32_t scale = depth_ - leaf.level;
  const auto coordinate = [scale](std::int32_t low, std::uint32_t site) {
    return static_cast<float>(low + static_cast<std::int32_t>((2U * site + 1U) << scale));
  };
  return {step_m_ * coordinate(leaf.min.x, (word >> 2) & 1023U),
          step_m_ * coordinate(leaf.min.y, (word >> 12) & 1023U),
          step_m_ * coordinate(leaf.min.z, word >> 22)};
}

LeafCursor::LeafCursor(const BlobView& view) : view_(view), done_(view.empty()) {
  if (!done_) {
    enter(0, {});
    next();
  }
}

void LeafCursor::enter(std::uint32_t node, Int3 cell) {
  cell_ = cell;
  const BlobNode here = view_.node(node, level_);
  stack_[level_] = {node, here.leaves >> 24, here.nodes >> 24};
}

void LeafCursor::next() {
  while (true) {  // bound: 2 * depth
    Frame& top = stack_[level_];
    if (top.leaves_left != 0) {
      const std::uint32_t octant = lowest_octant(top.leaves_left);
      top.leaves_left &= top.leaves_left - 1U;
      const Int3 cell = child_cell(cell_, octant);
      const std::int32_t edge = kLeafUnits << (view_.depth() - level_ - 1U);
      const Int3 root = view_.root_min();
      leaf_ = view_.leaf(child_leaf(view_.node(top.node, level_), octant), level_ + 1U,
                         {root.x + cell.x * edge, root.y + cell.y * edge, root.z + cell.z * edge});
      return;
    }
    if (top.nodes_left != 0) {
      const std::uint32_t octant = lowest_octant(top.nodes_left);
      top.nodes_left &= top.nodes_left - 1U;
      const std::uint32_t child = child_node(view_.node(top.node, level_), octant);
      ++level_;
      enter(child, child_cell(cell_, octant));
      continue;
    }
    if (level_ == 0) {
      done_ = true;
      return;
    }
    --level_;
    cell_ = {cell_.x >> 1, cell_.y >> 1, cell_.z >> 1};
  }
}

}  // namespace tactree::core
