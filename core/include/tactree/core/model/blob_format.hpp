#pragma once
// The layout of a blob, as specified by docs/FORMAT.md. Little-endian, position-independent, 4-byte
// aligned.
//
// A blob is a header, which may hold an extension and the interior, followed by sections that tile
// the rest of it without gaps:
//   nodes [, directory], leaf bases, leaf offsets, points, normals [, neighbours]
//   [, materials [, material indices]]
//
// All positions lie on an integer lattice: metres = step_m * integer. The step has few significant
// bits, so this product is exact in float32 for every lattice coordinate of the root cube. Every
// reader, in float or double, decodes the same number.
// A finest leaf is 2048 units wide and has 1024 sites on each axis, each in the middle of two
// units: a site is strictly inside its leaf.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactree::core {

static_assert(std::endian::native == std::endian::little, "blobs are read in place, little-endian");

inline constexpr std::uint8_t kBlobMagic[8] = {'T', 'A', 'C', 'T', 'R', 'E', 'E', 0};
inline constexpr std::uint16_t kBlobMajor = 1;
inline constexpr std::uint16_t kBlobMinor = 1;

inline constexpr std::uint32_t kMaxDepth = 11;  ///< octree levels below the root
inline constexpr std::uint32_t kLeafShift = 11;
inline constexpr std::int32_t kLeafUnits = 1
                                           << kLeafShift;  ///< edge of a finest leaf, lattice units
inline constexpr std::int32_t kMaxCoordinate = 1 << 22;  ///< |lattice coordinate| of the root cube
inline constexpr std::uint32_t kMaxLeaves = 1U << 24;
inline constexpr std::uint32_t kMaxNodes = 1U << 24;
inline constexpr std::uint32_t kMaxMaterials = 255;
inline constexpr std::uint32_t kLeavesPerQuery = 8;     ///< the eight-corner rule
inline constexpr std::uint32_t kMaxLevelsBelow = 10;    ///< between the directory and the leaves
inline constexpr std::uint32_t kMaxLeafGroupShift = 5;  ///< log2 of the leaves that share a base

enum class Profile : std::uint32_t {
  kSurface = 0,  ///< every leaf at full depth, leaf edge >= 2 reach: exact neighbour queries
  kPaper = 1,    ///< at most 10 points a leaf where the tree can split, with a neighbour table
};

/// Byte range of a section, counted from the start of the blob. An absent section is {end, 0}.
struct BlobSection {
  std::uint32_t offset;
  std::uint32_t bytes;
};

/// An IEEE double, kept as two words so that the blob needs no more than 4-byte alignment.
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
  std::uint32_t checksum;  ///< CRC-32 of every byte of the blob but these four

  std::uint32_t profile;  ///< Profile
  std::uint32_t depth;    ///< levels below the root; the root's edge is 2048 << depth lattice units
  float step_m;           ///< lattice unit: half a quantisation step
  std::int32_t root_min[3];  ///< lower corner of the root cube, lattice units

  std::uint32_t point_count;
  std::uint32_t leaf_count;
  std::uint32_t node_count;
  std::uint32_t material_count;

  std::uint32_t points_per_leaf_max;  ///< checked by open_blob()
  std::uint32_t points_per_ball_max;  ///< in any ball of radius reach_m: proven by the builder
  std::uint32_t
      points_per_query_max;  ///< in any eight leaves one query visits: proven by the builder
  std::uint32_t leaves_per_query_max;  ///< 8

  std::uint32_t directory_level;  ///< level of the nodes that the directory lists; 0: the root only
  std::uint32_t leaf_group_shift;  ///< 2^this leaves share a base

  float spacing_m;           ///< h: spacing of the resampled points
  float support_radius_m;    ///< R: radius of the surface fit
  float reach_m;             ///< R + slack: largest radius of an exact query
  float leaf_edge_min_m;     ///< E = 2048 step_m
  float aabb_edge_m;         ///< a: vertex box of the paper's collision test
  float six_point_offset_m;  ///< s
  float largest_gap_m;       ///< widest gap between points; 0: unknown
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
  std::uint32_t points_per_slab_max;  ///< in the part of these eight leaves that is 2 reach_m thick
                                      ///< along z: proven by the builder
  std::uint32_t reserved[4];          ///< 0
};

/// Follows the header if version_minor >= 1 and header_bytes has room for it.
struct BlobExtension {
  BlobSection interior;  ///< within header_bytes, behind this
};

/// An inner node: eight octants, each empty, an inner node or a leaf. Octant = x | y << 1 | z << 2,
/// a bit being set for the upper half. Children of one kind are consecutive, in octant order.
/// In the surface profile the level of a node determines the kind of its children, and only the
/// word of that kind is stored.
struct BlobNode {
  std::uint32_t nodes;   ///< bits 0-23: index of the first child node; bits 24-31: which octants
  std::uint32_t leaves;  ///< bits 0-23: number of the first child leaf; bits 24-31: which octants
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

// The directory lists the nodes of one level by their cells: x + y << level + z << 2 level.
inline constexpr std::uint32_t kNoNode = 0xFFFFFFFFU;  ///< directory entry: empty space

// A point is one word and one half word:
//   word  bits 31-22: z   21-12: y   11-2: x   (sites within the leaf)   1-0: bits 17-16 of the
//   normal half  bits 15-0 of the normal; the normal's bits 17-9 and 8-0 are the octahedral v and
//   u.
// Within a leaf the words ascend.
inline constexpr std::uint32_t kPointPositionMask = 0xFFFFFFFCU;

// The interior tells material from free space: one byte per node, then one per leaf; in the surface
// profile only.
//   node  bit o: octant o is empty: it lies in the material
//                octant o is a leaf: there is material behind its points, seen along their normals
//                octant o is a node: 0
//   leaf  bit o: its eighth o lies in the material, where that is further from all points than
//                reach_m
// Without it, each side of a surface counts as free.

// The neighbour table has six entries a leaf (-x +x -y +y -z +z), each the cell of the leaf's own
// size on that side: the leaf that is or contains it, or the node that divides it.
//   bits 0-23: leaf number or node index   bits 24-27: its level   bit 31: it is a node
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
