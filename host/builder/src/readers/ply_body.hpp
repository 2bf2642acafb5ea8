#pragma once
// Common to the readers of ASCII and binary PLY data: the elements and vertex properties in use.

#include <span>
#include <vector>

#include "input_file.hpp"
#include "ply_header.hpp"
#include "scan_builder.hpp"

namespace tactree::builder {

enum class PlyRole : std::uint8_t { kOther, kVertex, kFace, kStrip };

[[nodiscard]] PlyRole role_of(const PlyElement& element);

/// Index of the list of vertices of a face or strip, or properties.size() if there is none.
[[nodiscard]] std::size_t index_property(const PlyElement& element);

struct PlyField {
  std::size_t property = 0;
  Slot slot = kNoSlot;
};

/// The vertex properties in use: x y z, and normals and colours if complete.
[[nodiscard]] std::vector<PlyField> vertex_fields(const PlyElement& vertex);

/// Throws ReadError: the file holds only `rows_there` of the declared rows (or fewer if `at_most`).
[[noreturn]] void throw_truncated(const InputFile& file, const PlyElement& element,
                                  std::uint64_t rows_there, bool at_most = false);

/// Adds the triangles of a strip. An index of -1 starts a new strip.
class StripReader {
 public:
  StripReader(ScanBuilder& builder, std::uint64_t place) : builder_(builder), place_(place) {}
  void add(std::int64_t index);

 private:
  ScanBuilder& builder_;
  std::uint64_t place_;
  std::int64_t older_ = -1;
  std::int64_t newer_ = -1;
  std::uint64_t length_ = 0;
};

/// Reads the elements up to and including the last one in use. The file must be positioned after
/// the header. Returns the number of rows after them.
[[nodiscard]] std::uint64_t read_ply_ascii(InputFile& file, std::span<const PlyElement> elements,
                                           ScanBuilder& builder);
/// Reads the same elements of a binary file. Returns the average bytes per row of the last element.
[[nodiscard]] double read_ply_binary(InputFile& file, std::span<const PlyElement> elements,
                                     bool swap, ScanBuilder& builder);

}  // namespace tactree::builder
