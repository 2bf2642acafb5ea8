#pragma once
// The JSON of a glTF 2 file (text or GLB) and the numbers of its accessors. Every offset and count
// is checked against the actual bytes of the file before memory is allocated for it.

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_import/contained_files.hpp"
#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// In place of the index of an element.
inline constexpr std::size_t kNoIndex = std::numeric_limits<std::size_t>::max();

/// Refusal of JSON that has other values than the format requires.
inline constexpr const char* kNoStructure = "its JSON does not have the structure of glTF";

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

  /// Returns the numbers of an accessor. Throws ImportError if the accessor does not have `width`
  /// numbers per element. Normalized integers become -1 .. 1 or 0 .. 1.
  [[nodiscard]] std::vector<double> numbers(std::size_t accessor, std::size_t width);
  /// Returns the numbers of an accessor of indices.
  [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t accessor);
  /// Number of bytes after those that the header of a GLB declares.
  [[nodiscard]] std::size_t undeclared_bytes() const { return undeclared_bytes_; }
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
  /// `names` is an object with buffer, byteOffset and byteLength.
  [[nodiscard]] std::span<const unsigned char> stored(const nlohmann::json& names,
                                                      const std::string& who);
  /// Bytes of a buffer view, decompressed.
  [[nodiscard]] std::span<const unsigned char> view(std::size_t number, const std::string& who);
  /// `names` is an object with bufferView and byteOffset.
  [[nodiscard]] Elements elements(const nlohmann::json& names, std::size_t count,
                                  std::size_t component, std::size_t width, const std::string& who);
  template <typename Number>
  void read(std::size_t accessor, std::size_t width, std::vector<Number>& into);

  ContainedFiles& files_;
  std::string bytes_;  // the whole file
  nlohmann::json root_;
  int version_ = 2;
  std::size_t undeclared_bytes_ = 0;
  std::string_view chunk_;  // binary chunk of a GLB
  std::vector<std::string> buffers_;
  std::vector<bool> is_read_;
  std::map<std::size_t, std::vector<unsigned char>> decoded_;  // compressed buffer views
};

/// Reads a count or an index from the JSON; `missing` if it is absent. Throws ImportError if it is
/// not an integer from 0 to 2^40.
[[nodiscard]] std::size_t gltf_count(const nlohmann::json& object, const char* name,
                                     std::size_t missing = 0);

}  // namespace tactree::builder
