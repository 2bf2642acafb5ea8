#pragma once
// Access to models. open_blob() validates the bytes of a blob once and returns a BlobView that
// reads them in place. No other function creates a view of a model. Format: docs/FORMAT.md.
//
// Interrupt safety: a view is read-only; its functions may be called from any context. open_blob()
// takes too long for an interrupt.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/math/vec3.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::core {

enum class BlobStatus : std::uint8_t {
  kOk = 0,
  kMisaligned,     ///< the bytes do not start on a 4-byte boundary
  kTooShort,       ///< fewer bytes than a header
  kBadMagic,       ///< not a blob
  kBadVersion,     ///< the major version is not kBlobMajor
  kBadSize,        ///< total_bytes differs from the number of bytes passed
  kBadChecksum,    ///< damaged
  kBadHeader,      ///< a count, name or reserved field is impossible
  kBadFigures,     ///< a length, bound or lattice value is impossible or contradicts another
  kBadSections,    ///< sections do not tile the blob, or disagree with the counts
  kBadTree,        ///< the nodes are not in canonical order, or contradict the directory or the
                   ///< interior
  kBadLeaves,      ///< a leaf is empty, too full or out of order
  kBadPoints,      ///< points of a leaf are not in ascending order
  kBadNeighbours,  ///< a neighbour entry refers to no node or leaf
  kBadMaterials,   ///< a material is impossible, or an index refers to none
};

/// Human-readable text in static storage: "damaged: the checksum does not match", ...
[[nodiscard]] const char* describe(BlobStatus status);

/// A leaf of the octree and the range of its points.
struct Leaf {
  std::uint32_t number = 0;  ///< in depth-first order
  std::uint32_t first_point = 0;
  std::uint32_t point_count = 0;
  std::uint32_t level = 0;  ///< 0 is the root
  Int3 min{};               ///< lattice coordinates of its lower corner
};

/// A decoded point.
struct SurfacePoint {
  Vec3 position{};  ///< m, model frame; on each axis exactly step_m times an integer
  Vec3 normal{};    ///< unit length, outward
};

class LeafCursor;

/// A validated model, read in place. Copyable; the bytes must outlive every copy. If they change
/// (memory fault), results are wrong, but no access is out of range: each index that is read from
/// the bytes is compared with the counts stored at validation.
/// A default-constructed view is the empty model, in which no query finds anything.
class BlobView {
 public:
  BlobView() = default;

  [[nodiscard]] bool empty() const { return header_ == nullptr; }
  /// Precondition of all functions below: !empty().
  [[nodiscard]] const BlobHeader& header() const { return *header_; }
  [[nodiscard]] std::uint32_t point_count() const { return point_count_; }
  [[nodiscard]] std::uint32_t node_count() const { return node_count_; }
  [[nodiscard]] std::uint32_t leaf_count() const { return leaf_count_; }
  [[nodiscard]] float step_m() const { return step_m_; }
  [[nodiscard]] float inverse_step() const { return inverse_step_; }
  [[nodiscard]] std::uint32_t depth() const { return depth_; }
  /// Lower corner of the root cube, lattice units.
  [[nodiscard]] Int3 root_min() const { return root_min_; }
  /// Lower corner of the root cube and edge of a finest leaf, m; exact.
  [[nodiscard]] const float* root_min_m() const { return root_min_m_; }  // x, y, z, 0
  [[nodiscard]] float leaf_edge_m() const { return leaf_edge_m_; }
  [[nodiscard]] float inverse_leaf_edge() const { return inverse_leaf_edge_; }
  /// Number of finest cells along an edge of the root cube, plus one.
  [[nodiscard]] float cells_and_one() const { return cells_and_one_; }
  /// Maximum radius for which a query is exact.
  [[nodiscard]] float reach_m() const { return reach_m_; }
  [[nodiscard]] float support_radius_m() const { return support_radius_m_; }

  /// True in the surface profile: every leaf is of level depth(). A node is one word, the group of
  /// its children, which are leaves for a node of level depth() - 1, otherwise nodes.
  [[nodiscard]] bool is_uniform() const { return uniform_; }
  [[nodiscard]] const std::uint32_t* node_words() const { return nodes_; }
  [[nodiscard]] BlobNode node(std::uint32_t index, std::uint32_t level) const {
    if (!uniform_) {
      return {nodes_[2U * index], nodes_[2U * index + 1U]};  // memory: flash
    }
    // memory: flash
    return level + 1U < depth_ ? BlobNode{nodes_[index], 0} : BlobNode{0, nodes_[index]};
  }
  /// Table of the nodes of level directory_level(), by cell; kNoNode for empty space.
  [[nodiscard]] std::uint32_t directory_level() const { return directory_level_; }
  [[nodiscard]] const std::uint32_t* directory() const { return directory_; }

  /// Index of the first point of a leaf; for leaf_count(), the number of points.
  [[nodiscard]] std::uint32_t first_point(std::uint32_t leaf_number) const {
    // memory: flash
    return leaf_bases_[leaf_number >> leaf_group_shift_] + leaf_offsets_[leaf_number];
  }
  /// True if the points [first, end) exist. They may not exist after a memory fault.
  [[nodiscard]] bool holds_points(std::uint32_t first, std::uint32_t end) const {
    return first <= end && end <= point_count_;
  }
  /// The result has no points if the leaf or its points do not exist, e.g. after a memory fault.
  [[nodiscard]] Leaf leaf(std::uint32_t number, std::uint32_t level, Int3 min) const {
    if (number >= leaf_count_) {
      return {0, 0, 0, level, min};
    }
    const std::uint32_t first = first_point(number);
    const std::uint32_t end = first_point(number + 1);
    return {number, first, holds_points(first, end) ? end - first : 0U, level, min};
  }
  [[nodiscard]] const std::uint32_t* point_words() const { return points_; }

  /// Position and normal of point `index` of `leaf`. Preconditions: the leaf belongs to this view
  /// and contains the point. Cost: constant (one square root and one division for the normal).
  [[nodiscard]] Vec3 position(const Leaf& leaf, std::uint32_t index) const;
  [[nodiscard]] Vec3 normal(std::uint32_t index) const;
  [[nodiscard]] SurfacePoint surface_point(const Leaf& leaf, std::uint32_t index) const {
    return {position(leaf, index), normal(index)};
  }

  [[nodiscard]] bool has_neighbours() const { return neighbours_ != nullptr; }
  /// The six entries of a leaf (-x +x -y +y -z +z). Precondition: has_neighbours().
  [[nodiscard]] const std::uint32_t* neighbours(std::uint32_t leaf_number) const {
    return neighbours_ + 6U * leaf_number;
  }

  /// Interior flags, a byte per node, then a byte per leaf (blob_format.hpp). Null if the blob has
  /// none.
  [[nodiscard]] const std::uint8_t* interior() const { return interior_; }

  [[nodiscard]] std::uint32_t material_count() const { return material_count_; }
  /// Material `index`, or the first one if the index is out of range. Precondition:
  /// material_count() > 0.
  [[nodiscard]] const BlobMaterial& material(std::uint32_t index) const {
    return materials_[index < material_count_ ? index : 0U];
  }
  /// Index of a point's material; 0 in a blob with at most one material.
  [[nodiscard]] std::uint32_t material_of(std::uint32_t point) const {
    return material_indices_ == nullptr ? 0U : material_indices_[point];  // memory: flash
  }

 private:
  friend BlobStatus open_blob(std::span<const std::byte> bytes, BlobView& view);
  friend class BlobValidator;

  const BlobHeader* header_ = nullptr;
  const std::uint32_t* nodes_ = nullptr;
  const std::uint32_t* directory_ = nullptr;
  const std::uint32_t* leaf_bases_ = nullptr;
  const std::uint16_t* leaf_offsets_ = nullptr;
  const std::uint32_t* points_ = nullptr;
  const std::uint16_t* normals_ = nullptr;
  const std::uint32_t* neighbours_ = nullptr;
  const BlobMaterial* materials_ = nullptr;
  const std::uint8_t* material_indices_ = nullptr;
  const std::uint8_t* interior_ = nullptr;
  float step_m_ = 0.0F;
  float inverse_step_ = 0.0F;
  float reach_m_ = 0.0F;
  float support_radius_m_ = 0.0F;
  float leaf_edge_m_ = 0.0F;
  float inverse_leaf_edge_ = 0.0F;
  float cells_and_one_ = 0.0F;
  float root_min_m_[4] = {};
  Int3 root_min_{};
  std::uint32_t node_count_ = 0;
  std::uint32_t leaf_count_ = 0;
  std::uint32_t point_count_ = 0;
  std::uint8_t depth_ = 0;
  std::uint8_t directory_level_ = 0;
  std::uint8_t leaf_group_shift_ = 0;
  std::uint8_t material_count_ = 0;
  bool uniform_ = false;
};

// Octahedral map: Meyer, Suessmuth, Sussner and Stamminger, "On Floating-Point Normal Vectors",
// Eurographics Symposium on Rendering 2010.
inline Vec3 BlobView::normal(std::uint32_t index) const {
  // memory: flash
  const std::uint32_t code = static_cast<std::uint32_t>(normals_[index]) | (points_[index] & 3U)
                                                                               << 16;
  const float u = static_cast<float>(static_cast<std::int32_t>(code & 511U) - 255);
  const float v = static_cast<float>(static_cast<std::int32_t>(code >> 9) - 255);
  const float w = 255.0F - absolute(u) - absolute(v);
  Vec3 n{u, v, w};
  if (w < 0.0F) {
    const float fold = -w;
    n.x += u < 0.0F ? fold : -fold;
    n.y += v < 0.0F ? fold : -fold;
  }
  return (1.0F / length(n)) * n;
}

/// Validates `bytes`. After kOk, `view` reads them, and no query can read outside of them, whatever
/// their content. After any other status, `view` is empty.
/// Cost: linear in the number of bytes; no recursion; at most 256 bytes of stack.
[[nodiscard]] BlobStatus open_blob(std::span<const std::byte> bytes, BlobView& view);

/// Iterates over the leaves of a model in depth-first order (leaves of a node before its inner
/// nodes), which is the order of their numbers and points.
///   for (LeafCursor c(view); !c.done(); c.next()) use(c.leaf());
/// Cost of a full traversal: nodes + leaves steps. Stack: 11 levels of 12 bytes.
class LeafCursor {
 public:
  explicit LeafCursor(const BlobView& view);
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] const Leaf& leaf() const { return leaf_; }
  void next();

 private:
  struct Frame {
    std::uint32_t node;
    std::uint32_t leaves_left;  // masks of octants
    std::uint32_t nodes_left;
  };

  void enter(std::uint32_t node, Int3 cell);

  BlobView view_;
  Frame stack_[kMaxDepth] = {};
  std::uint32_t level_ = 0;
  Int3 cell_{};  // of the node on top of the stack, in cells of its level
  Leaf leaf_{};
  bool done_ = true;
};

/// Calls use(leaf, index) for each point of a model in ascending order. Cost: a full traversal.
template <typename Use>
void for_each_point(const BlobView& view, Use&& use) {
  for (LeafCursor cursor(view); !cursor.done(); cursor.next()) {  // bound: kMaxLeaves
    const Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {  // bound: points_per_leaf_max
      use(leaf, leaf.first_point + i);
    }
  }
}

}  // namespace tactree::core
