#pragma once
// Reads the vertices and triangles of a 3MF model part while it is unpacked, and keeps the rest of
// the document. A document tree of a large mesh would take ten times the memory of the mesh.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// The content of an element "vertices" or "triangles".
struct MeshBlock {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Parses a number, with space around it; nullopt if `text` is anything else.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// The refusal of a text that is not a number: "12,7" is not a `what`.
[[nodiscard]] ImportError not_a(std::string_view text, const std::string& what);

/// Metres per unit that a 3MF or AMF file names; millimetres if it names none. Throws ImportError
/// for an unknown name.
[[nodiscard]] double metres_of_print_unit(std::string_view name);

/// Parses an index. Invalid text becomes the maximum, so that the triangle is dropped.
[[nodiscard]] std::uint32_t index_of(std::string_view text);

class MeshExtractor {
 public:
  /// Takes the next bytes of the document. Returns false if the document has a form that must be
  /// read as a whole: malformed, UTF-16, with a document type, or with other content in a block.
  [[nodiscard]] bool feed(std::string_view bytes);

  /// After the last bytes: false if the document is incomplete.
  [[nodiscard]] bool is_complete() const;

  /// Cause of a refusal, such as a coordinate that is not a number; empty if there is none.
  [[nodiscard]] const std::string& error() const { return error_; }

  /// The document, in which the content of a block is its index in blocks().
  [[nodiscard]] std::string take_rest() { return std::move(rest_); }
  [[nodiscard]] std::vector<MeshBlock>& blocks() { return blocks_; }

 private:
  enum class Inside : std::uint8_t { kDocument, kVertices, kTriangles, kUnused };

  bool take_text(std::string_view text);
  bool take_markup(std::string_view markup);
  bool take_tag(std::string_view tag);
  void begin_block(std::string_view name);
  /// Of the elements in the present block of a mesh.
  [[nodiscard]] std::string_view element_name() const;
  bool take_element(std::string_view name, std::string_view attributes, bool empty);
  bool add_vertex(std::string_view attributes);
  bool add_triangle(std::string_view attributes);

  std::string open_;  // bytes of markup whose end is not there yet
  std::string rest_;
  std::vector<MeshBlock> blocks_;
  std::string error_;
  std::string block_name_;  // local name of the element that is being read
  bool element_open_ = false;
  bool begun_ = false;
  Inside inside_ = Inside::kDocument;
};

}  // namespace tactree::builder
