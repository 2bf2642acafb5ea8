#pragma once
// The JSON of a glTF 2 file (text or GLB) and the numbers of its accessors. Every offset and count
// is checked against the bytes that the file really has, before memory is taken for it.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_import/contained_files.hpp"
#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

class GltfFile {
 public:
  /// `files` opens the file and the buffers beside it, and must outlive this object. Throws
  /// ImportError.
  GltfFile(const std::string& file, ContainedFiles& files);

  /// 1 for a file of glTF 1, which has another structure.
  [[nodiscard]] int version() const { return version_; }
  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  /// Entry of a list of the root, such as "nodes". Throws ImportError if there is none.
  [[nodiscard]] const nlohmann::json& at(const char* list, std::size_t number) const;

  /// The numbers of an accessor, `width` per element (an accessor of fewer or more is refused;
  /// colours may have three or four). Normalized integers become -1 ... 1 or 0 ... 1. Throws
  /// ImportError.
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor, std::size_t width);
  /// Whole numbers: indices.
  [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t accessor);
  /// Numbers per element of an accessor.
  [[nodiscard]] std::size_t width(std::size_t accessor) const;

 private:
  struct Elements {
    std::span<const unsigned char> bytes;  // from the first element
    std::size_t count = 0;
    std::size_t stride = 0;
    std::size_t component = 0;
    bool normalized = false;
  };
  void read_binary(std::string_view chunks);
  [[nodiscard]] std::string_view buffer(std::size_t number);
  [[nodiscard]] std::string read_buffer(std::size_t number) const;
  [[nodiscard]] std::span<const unsigned char> view(std::size_t number, const std::string& who);
  /// names: an object with bufferView and byteOffset.
  [[nodiscard]] Elements elements(const nlohmann::json& names, std::size_t count,
                                  std::size_t component, std::size_t width, const std::string& who);
  template <typename Number>
  void read(std::size_t accessor, std::size_t width, std::vector<Number>& into);

  ContainedFiles& files_;
  std::string bytes_;  // of the whole file
  nlohmann::json root_;
  int version_ = 2;
  std::string_view chunk_;  // binary part of a GLB
  std::vector<std::string> buffers_;
  std::vector<bool> is_read_;
};

/// A number of the JSON that counts or points; `missing` if there is none. Throws ImportError if it
/// is no whole number from 0 to 2^40.
[[nodiscard]] std::size_t gltf_count(const nlohmann::json& object, const char* name,
                                     std::size_t missing = 0);

}  // namespace tactree::builder
