#pragma once
// The layout of a blob, as specified by docs/FORMAT.md. Little-endian, position-independent, 4-byte
// aligned.
//
// A blob is a header, which may contain an extension and the interior, followed by sections that
// fill the rest of the blob without gaps:
//   nodes [, directory], leaf bases, leaf offsets, points, normals [, neighbours]
//   [, materials [, material indices]]
//
// All positions lie on an integer lattice: metres = step_m * integer. The step has few significant
// bits, so this product is exact in float32 for every lattice coordinate of the root cube. Every
// reader, in float or double, decodes the same number.
// A leaf of the finest level is 2048 units wide and has 1024 sites on each axis. A site is at the
// centre of two units, hence strictly inside its leaf.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactree::core {

static_assert(std::endian::native == std::endian::little, "blobs are read in place, little-endian");

inline constexpr std::uint8_t kBlobMagic[8] = {'T', 'A', 'C', 'T', 'R', 'E', 'E', 0};
inline constexpr std::uint16_t kBlobMajor = 1;
inline constexpr std::uint16_t kBlobMinor = 2;

/// The root cube is then 2^22 lattice units wide, so that it is within kMaxCoordinate wherever the
/// origin lies in it. With leaves of 6 spacings, its edge is 2048 leaves or 12 288 spacings.
inline constexpr std::uint32_t kMaxDepth = 11;  ///< octree levels below the root
/// The 10 bits of a point's site, and one so that the centre of a site is an integer.
inline constexpr std::uint32_t kLeafShift = 11;
inline constexpr std::int32_t kLeafUnits = 1
                                           << kLeafShift;  ///< edge of a finest leaf, lattice units
/// |lattice coordinate| of the root cube. Leaves 2 of the 24 significant bits of a float to step_m.
inline constexpr std::int32_t kMaxCoordinate = 1 << 22;
inline constexpr std::uint32_t kMaxLeaves = 1U << 24;  ///< a child index has 24 bits
inline constexpr std::uint32_t kMaxNodes = 1U << 24;   ///< a child index has 24 bits
inline constexpr std::uint32_t kMaxMaterials = 255;    ///< index and count are bytes
inline constexpr std::uint32_t kLeavesPerQuery = 8;    ///< the eight-corner rule
/// Levels between the directory and the leaves. Three coordinates of 10 bits fit into a word.
inline constexpr std::uint32_t kMaxLevelsBelow = 10;
/// With 5, the bases take 1/8 byte for each leaf and the offsets 2 bytes; with 0 the bases would
/// take 4 bytes, with more than 5 they could shrink by less than 1/8 byte.
inline constexpr std::uint32_t kMaxLeafGroupShift = 5;  ///< log2 of the leaves that share a base

enum class Profile : std::uint32_t {
  kSurface = 0,  ///< every leaf at full depth, leaf edge >= 2 reach: exact neighbour queries
  kPaper = 1,    ///< at most 10 points per leaf where the tree can split; a neighbour table
};

/// Byte range of a section; the offset counts from the start of the blob. An absent section has the
/// offset at which it would begin, and 0 bytes.
struct BlobSection {
  std::uint32_t offset;
  std::uint32_t bytes;
};

/// An IEEE 754 double, stored as two words so that 4-byte alignment is sufficient.
struct BlobDouble {
  std::uint32_t low;
  std::uint32_t high;
};

struct BlobHeader {
  std::uint8_t magic[8];
  std::uint16_t version_major;
  std::uint16_t version_minor;
  std::uint32_t header_bytes;
  std::uint32_t total_bytes;
  std::uint32_t checksum;  ///< CRC-32 of the blob without these four bytes

  std::uint32_t profile;  ///< Profile
  std::uint32_t depth;    ///< levels below the root; the root's edge is 2048 << depth lattice units
  float step_m;           ///< lattice unit: half a quantisation step
  std::int32_t root_min[3];  ///< lower corner of the root cube, lattice units

  std::uint32_t point_count;
  std::uint32_t leaf_count;
  std::uint32_t node_count;
  std::uint32_t material_count;

  std::uint32_t points_per_leaf_max;   ///< checked by open_blob()
  std::uint32_t points_per_ball_max;   ///< in any ball of radius reach_m; proven by the builder
  std::uint32_t points_per_query_max;  ///< in the leaves of any query; proven by the builder
  std::uint32_t leaves_per_query_max;  ///< 8

  std::uint32_t directory_level;  ///< level of the nodes that the directory lists; 0: the root only
  std::uint32_t leaf_group_shift;  ///< 2^leaf_group_shift leaves share a base

  float spacing_m;           ///< h: spacing of the resampled points
  float support_radius_m;    ///< R: radius of the surface fit
  float reach_m;             ///< R + slack: maximum radius of an exact query
  float leaf_edge_min_m;     ///< E = 2048 step_m
  float aabb_edge_m;         ///< a: edge of the vertex boxes of the paper's collision test
  float six_point_offset_m;  ///< s: displacement of the paper's six points
  float largest_gap_m;       ///< maximum gap between points; 0: unknown
  float bounds_min_m[3];     ///< of the decoded points
  float bounds_max_m[3];

  BlobSection nodes;
  BlobSection directory;
  BlobSection leaf_bases;
  BlobSection leaf_offsets;
  BlobSection points;
  BlobSection normals;
  BlobSection neighbours;
  BlobSection materials;
  BlobSection material_indices;

  BlobDouble source_scale;      ///< metres of the model frame per unit of the source file
  BlobDouble source_origin[3];  ///< source coordinates of the model frame's origin

  char name[32];                      ///< UTF-8, zero-padded, zero-terminated
  std::uint8_t source_digest[32];     ///< SHA-256 of the input bytes
  char tool_version[16];              ///< zero-padded, zero-terminated
  std::uint32_t points_per_slab_max;  ///< in any slab of these leaves that is 2 reach_m thick along
                                      ///< z; proven by the builder
  /// In any ball of radius support_radius_m; proven by the builder. 0: not known, at most
  /// points_per_ball_max. See points_per_support_max().
  std::uint32_t points_per_support_max;
  std::uint32_t reserved[3];  ///< 0
};

/// Limit of the points in the support of a fit.
[[nodiscard]] constexpr std::uint32_t points_per_support_max(const BlobHeader& header) {
  const std::uint32_t known = header.points_per_support_max;
  return known == 0 ? header.points_per_ball_max : known;
}

/// Follows the header if version_minor >= 1 and header_bytes is large enough.
struct BlobExtension {
  BlobSection interior;  ///< within header_bytes, after the extension; {0, 0} if absent
};

/// An inner node. Each of its eight octants is empty, an inner node or a leaf. The number of an
/// octant is x | y << 1 | z << 2, where a set bit means the upper half. Children of one kind are
/// consecutive, in octant order. In the surface profile the level of a node determines the kind of
/// its children, and only the word of that kind is stored.
struct BlobNode {
  std::uint32_t nodes;   ///< bits 0-23: index of the first child node; bits 24-31: octant mask
  std::uint32_t leaves;  ///< bits 0-23: number of the first child leaf; bits 24-31: octant mask
};

/// Contact parameters of the points with this material.
struct BlobMaterial {
  float stiffness_N_m;
  float damping_Ns_m;
  float static_friction;
  float dynamic_friction;
  float texture_height_m;
  float texture_wavelength_m;
  std::uint32_t reserved[2];  ///< 0
};

// The directory lists the nodes of one level. Index of a cell: x | y << level | z << 2 * level.
inline constexpr std::uint32_t kNoNode = 0xFFFFFFFFU;  ///< directory entry: empty space

// A point is one word and one half word:
//   word       bits 31-22: z, 21-12: y, 11-2: x (site in the leaf), 1-0: bits 17-16 of the normal
//   half word  bits 15-0 of the normal
//   normal     bits 17-9: octahedral v, 8-0: octahedral u
// The position bits of a leaf's words are in ascending order.
inline constexpr std::uint32_t kPointPositionMask = 0xFFFFFFFCU;

// The interior distinguishes material from free space, in the surface profile only: one byte per
// node, then one byte per leaf.
//   node  bit o, octant o is empty:  1 if the octant lies in the material
//         bit o, octant o is a leaf: 1 if there is material behind its points, opposite to their
//                                    normals
//         bit o, octant o is a node: 0
//   leaf  bit o: 1 if octant o of the leaf lies in the material; applies only to positions that are
//         further than reach_m from all points
// Without an interior, both sides of a surface count as free space.

// The neighbour table has six entries per leaf (-x +x -y +y -z +z). Each describes the adjacent
// cell of the leaf's size: the leaf that equals or contains this cell, or the node that divides it.
//   bits 0-23: leaf number or node index   bits 24-27: its level   bit 31: set for a node
inline constexpr std::uint32_t kNeighbourNone = 0xFFFFFFFFU;  ///< empty space or outside the root
inline constexpr std::uint32_t kNeighbourIsNode = 0x80000000U;
inline constexpr std::uint32_t kNeighbourIndexMask = 0x00FFFFFFU;
inline constexpr std::uint32_t kNeighbourLevelShift = 24;

static_assert(sizeof(BlobSection) == 8);
static_assert(sizeof(BlobDouble) == 8);
static_assert(sizeof(BlobNode) == 8);
static_assert(sizeof(BlobMaterial) == 32);
static_assert(sizeof(BlobHeader) == 344);
static_assert(sizeof(BlobExtension) == 8);
static_assert(alignof(BlobHeader) == 4);
static_assert(offsetof(BlobHeader, checksum) == 20);
static_assert(offsetof(BlobHeader, profile) == 24);
static_assert(offsetof(BlobHeader, point_count) == 48);
static_assert(offsetof(BlobHeader, points_per_leaf_max) == 64);
static_assert(offsetof(BlobHeader, spacing_m) == 88);
static_assert(offsetof(BlobHeader, nodes) == 140);
static_assert(offsetof(BlobHeader, source_scale) == 212);
static_assert(offsetof(BlobHeader, name) == 244);
static_assert(offsetof(BlobHeader, tool_version) == 308);
static_assert(std::is_trivially_copyable_v<BlobHeader>);

}  // namespace tactree::core
