#pragma once
// Reads a scan file: PLY, PCD, PTX, E57, LAS, text (XYZ, PTS, CSV), OBJ, STL, OFF; glTF, 3MF and
// the formats of the assimp library (FBX, 3DS, COLLADA, ...) in a separate process with limits.
//
// The format is recognised by content, never by the file name. Files are untrusted: counts are
// compared with the file size before memory is allocated for them.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {

/// Column numbers of a text file, from 1, by content: x, y, z, nx, ny, nz, red, green, blue.
using ColumnMap = std::map<std::string, std::size_t>;

/// Parses "x=2,y=3,z=4,red=5,green=6,blue=7". Throws std::invalid_argument with the cause.
[[nodiscard]] ColumnMap parse_columns(std::string_view text);

/// Names of the formats that have a reader (the usual file name extensions), "ply" first.
[[nodiscard]] std::vector<std::string> scan_formats();

/// Cause in Scan::dropped of points that were thinned while they were read.
inline constexpr const char* kBeyondMemoryLimit = "beyond_memory_limit";

struct ReadOptions {
  /// Memory limit of a scan that is not thinned, bytes. A larger scan is refused before its memory
  /// is allocated.
  std::uint64_t scan_memory_bytes = 3ULL << 29;
  /// A cloud with more points is thinned while it is read: of each cube of a grid the first point
  /// is kept, with the finest grid of edges 2^n that leaves at most this many (4 if it is less).
  /// A mesh is not, nor is a cloud if this is 0: they are refused above the memory limit.
  std::uint64_t most_points = 0;
  /// Address space limit of the mesh import process, bytes.
  std::uint64_t child_memory_bytes = 3ULL << 29;
  /// Limit of both the processor time and the elapsed time of the mesh import process.
  double child_seconds = 120.0;
  /// Columns of a text file; empty: detected from its header or its numbers. With columns, other
  /// formats are refused, but text of a mesh or grid without a reader is read as rows of numbers.
  ColumnMap columns;
  /// Format of the file, one of scan_formats(); empty: detected by content.
  std::string format;
  /// Name of the file in messages; empty: its path.
  std::string label;
  /// Called repeatedly with the fraction of the file that has been read, which rises from 0 to 1.
  std::function<void(double fraction)> progress;
};

/// Reads `file`. Throws ReadError if it is not a scan, is damaged beyond use or contains no points.
/// Damage that leaves a usable scan is counted in Scan::dropped and described in Scan::warnings:
///   "not_measured"           points that the file itself marks as invalid (PTX, E57)
///   "withheld"               points of a LAS file that are marked as deleted
///   "noise"                  points that a LAS file classifies as noise
///   "non_finite"             positions with NaN or infinite coordinates
///   "beyond_memory_limit"    points of a cloud with more than ReadOptions::most_points
///   "bad_row"                rows of a text file that are not a point
///   "degenerate_face"        faces with fewer than three distinct vertices
///   "face_index_out_of_range" faces with the index of a point that does not exist
///   "face_non_finite"        faces with a vertex that was dropped as non_finite
/// A normal that is missing or NaN becomes the zero vector.
/// Cost: one pass over the file, memory for the result and a buffer of a few MiB.
[[nodiscard]] Scan read_scan(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace tactree::builder
