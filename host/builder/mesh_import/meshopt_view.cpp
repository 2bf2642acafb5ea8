#include "mesh_import/meshopt_view.hpp"

#include <meshoptimizer.h>

#include "mesh_import/gltf_file.hpp"

namespace tactree::builder {
namespace {

using nlohmann::json;

// The codec of attributes has two bits for 16 equal bytes; those of indices pack less.
constexpr std::size_t kMaxPackingRatio = 64;
constexpr std::size_t kMaxStride = 256;

struct Layout {
  std::size_t count = 0;
  std::size_t stride = 0;
  std::string mode;
  std::string filter;
};

/// The library does not check the layout.
bool is_valid(const Layout& layout) {
  if (layout.mode == "ATTRIBUTES") {
    if (layout.stride % 4 != 0 || layout.stride == 0 || layout.stride > kMaxStride) {
      return false;
    }
    return layout.filter == "NONE" || layout.filter == "EXPONENTIAL" ||
           (layout.filter == "OCTAHEDRAL" && layout.stride <= 8) ||
           (layout.filter == "QUATERNION" && layout.stride == 8);
  }
  const bool is_list =
      layout.mode == "TRIANGLES" ? layout.count % 3 == 0 : layout.mode == "INDICES";
  return is_list && (layout.stride == 2 || layout.stride == 4) && layout.filter == "NONE";
}

bool decode(const Layout& layout, std::span<const unsigned char> packed, unsigned char* into) {
  const auto [count, stride, mode, filter] = layout;
  if (mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(into, count, stride, packed.data(), packed.size()) == 0;
  }
  if (mode == "INDICES") {
    return meshopt_decodeIndexSequence(into, count, stride, packed.data(), packed.size()) == 0;
  }
  if (meshopt_decodeVertexBuffer(into, count, stride, packed.data(), packed.size()) != 0) {
    return false;
  }
  if (filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(into, count, stride);
  } else if (filter == "QUATERNION") {
    meshopt_decodeFilterQuat(into, count, stride);
  } else if (filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(into, count, stride);
  }
  return true;
}

}  // namespace

const json* meshopt_of(const json& view) {
  const auto extensions = view.find("extensions");
  if (extensions == view.end()) {
    return nullptr;
  }
  const auto found = extensions->find(kMeshopt);
  return found == extensions->end() ? nullptr : &*found;
}

std::vector<unsigned char> decoded_meshopt(const json& view, std::span<const unsigned char> packed,
                                           const std::string& who) {
  const json& extension = *meshopt_of(view);
  const Layout layout = {gltf_count(extension, "count"), gltf_count(extension, "byteStride"),
                         extension.value("mode", std::string()),
                         extension.value("filter", std::string("NONE"))};
  if (!is_valid(layout)) {
    throw ImportError(who + " has an invalid layout of " + kMeshopt + " (mode, filter or stride)");
  }
  // At most 2^40 elements of 256 bytes: the product does not overflow.
  const std::size_t size = layout.count * layout.stride;
  if (size > packed.size() * kMaxPackingRatio) {
    throw ImportError(who + " states " + std::to_string(layout.count) +
                      " elements, which its compressed bytes cannot hold");
  }
  if (size != gltf_count(view, "byteLength")) {
    throw ImportError(who + " has another byteLength than its compressed bytes");
  }
  std::vector<unsigned char> bytes(size);
  if (layout.count > 0 && !decode(layout, packed, bytes.data())) {
    throw ImportError("the compressed bytes of " + who + " are damaged");
  }
  return bytes;
}

}  // namespace tactree::builder
