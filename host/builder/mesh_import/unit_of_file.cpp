#include "mesh_import/unit_of_file.hpp"

#include <assimp/metadata.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

namespace tactree::builder {
namespace {

constexpr std::size_t kHeadBytes = std::size_t{1} << 20;  // of a text file: its unit comes early
constexpr std::size_t kModelHeadBytes = 4096;             // of the model in a 3MF

std::string read_file(const std::string& file, std::size_t most) {
  std::ifstream in(file, std::ios::binary);
  std::string text(most, '\0');
  in.read(text.data(), static_cast<std::streamsize>(most));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

// The value of an attribute of the first element with this name; empty: none.
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

std::uint32_t little(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < count; ++k) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
  }
  return value;
}

// The first bytes of a member of a zip archive.
std::string inflated(const std::string& zip, std::size_t at, bool compressed) {
  std::string head(kModelHeadBytes, '\0');
  if (!compressed) {
    return zip.substr(at, kModelHeadBytes);
  }
  z_stream stream{};
  std::string input = zip.substr(at);
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(head.data());
  stream.avail_out = static_cast<uInt>(head.size());
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) {
    return {};
  }
  ::inflate(&stream, Z_SYNC_FLUSH);  // a prefix is enough
  head.resize(head.size() - stream.avail_out);
  ::inflateEnd(&stream);
  return head;
}

// The first bytes of the model of a 3MF: its first member whose name ends in ".model".
std::string model_of_3mf(const std::string& file) {
  constexpr std::size_t kLocalHeader = 30;
  constexpr std::size_t kMaxBytes = std::size_t{1} << 28;
  const std::string zip = read_file(file, kMaxBytes);
  for (std::size_t at = zip.find("PK\x03\x04"); at != std::string::npos;
       at = zip.find("PK\x03\x04", at + 4)) {
    if (at + kLocalHeader > zip.size()) {
      break;
    }
    const std::size_t name = little(zip, at + 26, 2);
    const std::size_t data = at + kLocalHeader + name + little(zip, at + 28, 2);
    const std::string path = zip.substr(at + kLocalHeader, name);
    if (path.ends_with(".model") && data < zip.size()) {
      return inflated(zip, data, little(zip, at + 8, 2) != 0);
    }
  }
  return {};
}

double unit_of_3mf(const std::string& file) {
  static const std::vector<std::pair<std::string, double>> kUnits = {
      {"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
      {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1.0}};
  const std::string stated = attribute(model_of_3mf(file), "model", "unit");
  for (const auto& [name, metres] : kUnits) {
    if (name == stated) {
      return metres;
    }
  }
  return 1e-3;
}

double unit_of_collada(const std::string& file) {
  const double metres =
      std::strtod(attribute(read_file(file, kHeadBytes), "unit", "meter").c_str(), nullptr);
  return metres > 0.0 && std::isfinite(metres) ? metres : 1.0;
}

// Centimetres per unit.
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
  if (hint == "3mf") {
    return {unit_of_3mf(file), false};
  }
  if (hint == "dae") {
    return {unit_of_collada(file), true};
  }
  return {};
}

}  // namespace tactree::builder
