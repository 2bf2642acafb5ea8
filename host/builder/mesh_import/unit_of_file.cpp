#include "mesh_import/unit_of_file.hpp"

#include <assimp/metadata.h>

#include <cmath>
#include <cstdlib>

#include "mesh_import/file_bytes.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{1} << 20;  // of a text file; its unit comes early

// Value of an attribute of the first element with this name; empty if there is none.
std::string attribute(const std::string& text, const std::string& element,
                      const std::string& name) {
  std::size_t at = text.find("<" + element);
  const std::size_t end = text.find('>', at);
  while (at != std::string::npos && at < end) {
    at = text.find(name, at + 1);
    if (at == std::string::npos || at >= end) {
      break;
    }
    std::size_t quote = at + name.size();
    while (quote < end && (text[quote] == ' ' || text[quote] == '=')) {
      ++quote;
    }
    const bool whole = text[at - 1] == ' ' || text[at - 1] == '\n' || text[at - 1] == '\t';
    if (whole && quote < end && (text[quote] == '"' || text[quote] == '\'')) {
      return text.substr(quote + 1, text.find(text[quote], quote + 1) - quote - 1);
    }
  }
  return {};
}

double unit_of_collada(const std::string& file) {
  const double metres =
      std::strtod(attribute(file_bytes(file, kHeadBytes), "unit", "meter").c_str(), nullptr);
  return metres > 0.0 && std::isfinite(metres) ? metres : 1.0;
}

// Returns metres per unit, or 0 if unknown. UnitScaleFactor is in centimetres.
double unit_of_fbx(const aiScene& scene) {
  double wide = 0.0;
  float narrow = 0.0F;
  if (scene.mMetaData == nullptr) {
    return 0.0;
  }
  if (scene.mMetaData->Get("UnitScaleFactor", wide)) {
    return 0.01 * wide;
  }
  return scene.mMetaData->Get("UnitScaleFactor", narrow) ? 0.01 * static_cast<double>(narrow) : 0.0;
}

}  // namespace

FileUnit unit_of_file(const aiScene& scene, const std::string& file, std::string_view hint) {
  if (hint == "gltf" || hint == "glb" || hint == "x3d") {
    return {1.0, false};
  }
  if (hint == "fbx") {
    const double metres = unit_of_fbx(scene);
    return {metres > 0.0 && std::isfinite(metres) ? metres : 0.0, false};
  }
  if (hint == "dae") {
    return {unit_of_collada(file), true};
  }
  return {};
}

}  // namespace tactree::builder
