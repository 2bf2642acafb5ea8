#pragma once
// Reads a scan file into memory: PLY, PCD, text (XYZ, PTS, CSV), OBJ, STL, OFF, and through a
// separate, limited process what the assimp library knows (glTF, FBX, 3DS, COLLADA, ...).
//
// The format is recognised by content, never by the file's name. Nothing in a file is trusted:
// counts are compared with the file's size before memory is taken for them. Files are only read.

#include <cstdint>
#include <filesystem>
#include <functional>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {

struct ReadOptions {
  /// What the scan may take in memory; a larger one is refused before the memory is taken.
  std::uint64_t scan_memory_bytes = 3ULL << 29;
  /// What the mesh import process may take (address space).
  std::uint64_t child_memory_bytes = 3ULL << 29;
  /// How long the mesh import process may take, in processor time and by the clock.
  double child_seconds = 120.0;
  /// Called now and then with the fraction of the file that was read, rising from 0 to 1.
  std::function<void(double fraction)> progress;
};

/// Reads `file`. Throws ReadError when it is not a scan, is damaged beyond use or holds no point.
/// Damage that leaves a usable scan is counted in Scan::dropped and told in Scan::warnings:
///   "non_finite"             positions with NaN or infinite coordinates
///   "bad_row"                rows of a text file that are not a point
///   "degenerate_face"        faces with fewer than three distinct corners
///   "face_index_out_of_range" faces that name a point the file does not have
///   "face_non_finite"        faces with a corner that was dropped as non_finite
/// A normal that the file does not give, or gives as NaN, is the zero vector.
/// Cost: one pass over the file, memory for the result and a buffer of a few MiB.
[[nodiscard]] Scan read_scan(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace tactree::builder
