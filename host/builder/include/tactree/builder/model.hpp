#pragma once
// Input of the blob writer: resampled points with oriented normals, in the model frame.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/model/blob_format.hpp"

namespace tactree::builder {

struct Model {
  std::vector<Eigen::Vector3d> positions;      ///< m, model frame
  std::vector<Eigen::Vector3f> normals;        ///< unit length, outward; one per position
  std::vector<std::uint8_t> material_indices;  ///< empty, or one per position
  std::vector<core::BlobMaterial> materials;
  std::vector<std::uint8_t> doubtful;  ///< empty, or one per position; 1: ambiguous orientation

  double spacing_m = 0.0;         ///< h
  double support_radius_m = 0.0;  ///< R
  double reach_m = 0.0;           ///< R + slack
  double largest_gap_m = 0.0;
  core::Profile profile = core::Profile::kSurface;
  bool tells_interior = false;  ///< `surface` profile: determine and store where the material is
  std::uint32_t points_per_leaf_wanted =
      10;  ///< `paper` profile: leaves with more points are split

  double source_scale = 1.0;                                ///< model metres per source unit
  Eigen::Vector3d source_origin = Eigen::Vector3d::Zero();  ///< origin of the model, source units
  std::string name;
  std::array<std::uint8_t, 32> source_digest{};
};

/// A blob, and for each of its points the index of the encoded position.
struct WrittenBlob {
  std::vector<std::byte> bytes;             ///< 4-byte aligned storage
  std::vector<std::uint32_t> source_index;  ///< blob point -> model position
  std::uint64_t merged = 0;                 ///< points that shared a lattice site with another
  std::uint64_t interior_bytes_max = 0;     ///< of the interior, which only a body has
  double backed_share = 0.0;  ///< ratio of points with material behind them, if the blob stores it
};

/// Quantises the model, builds the octree and serialises it; the result has passed
/// core::open_blob(). Deterministic. Throws std::runtime_error with a message for the user if the
/// model cannot be represented (too large for its spacing, no points). Cost: about 20 us per point.
[[nodiscard]] WrittenBlob write_blob(const Model& model);

/// Recomputes the checksum in the header. Precondition: `blob` holds at least a header.
void seal(std::span<std::byte> blob);

}  // namespace tactree::builder
