#include "mesh_import/import_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include "mesh_import/contained_files.hpp"
#include "mesh_import/scene_writer.hpp"
#include "mesh_import/unit_of_file.hpp"

namespace tactree::builder {
namespace {

void configure(Assimp::Importer& importer) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_TEXCOORDS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  // Positions stay in the frame of the file.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
}

/// Reads and checks the scene; null on failure.
const aiScene* read_scene(Assimp::Importer& importer, const std::string& file,
                          std::string_view hint) {
  constexpr unsigned kSteps = aiProcess_ValidateDataStructure | aiProcess_RemoveComponent |
                              aiProcess_Triangulate | aiProcess_JoinIdenticalVertices;
  if (hint != "3mf") {
    return importer.ReadFile(file, kSteps);
  }
  // The library leaves the size of a 3MF's pictures, such as its thumbnail, undefined and does not
  // own their pixels: its check refuses them, and to free them would end the process.
  if (importer.ReadFile(file, 0) == nullptr) {
    return nullptr;
  }
  auto* scene = const_cast<aiScene*>(importer.GetScene());  // NOLINT: it has no other access
  scene->mNumTextures = 0;
  scene->mTextures = nullptr;
  return importer.ApplyPostProcessing(kSteps);
}

/// The compression of the data that makes a glTF file unreadable, or null.
const char* compression_of(const char* file) {
  constexpr std::string_view kName = "EXT_meshopt_compression";
  std::ifstream in(file, std::ios::binary);
  std::string text(std::size_t{1} << 20, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text.find(kName) != std::string::npos ? kName.data() : nullptr;
}

bool refuse(int output, const char* text) {
  write_status(output, WireStatus::kRefused, text);
  return false;
}

}  // namespace

bool import_file(const char* file, const char* hint, int output) {
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(hint)) {
    return refuse(output, "this version of assimp has no reader for the format");
  }
  configure(importer);
  auto* files = new ContainedFiles(file, hint);
  importer.SetIOHandler(files);  // takes ownership
  const aiScene* scene = read_scene(importer, files->alias(), hint);
  if (scene == nullptr) {
    if (const char* compression = compression_of(file)) {
      return refuse(output, (std::string("its data is compressed with ") + compression +
                             ", which is not supported")
                                .c_str());
    }
    std::string reason = importer.GetErrorString();
    const std::size_t alias = reason.find(files->alias());
    if (alias != std::string::npos) {
      reason.replace(alias, files->alias().size(), file);
    }
    return refuse(output, reason.c_str());
  }
  std::FILE* to = ::fdopen(output, "wb");
  SceneWriter writer(*scene, unit_of_file(*scene, file, hint), to);
  return writer.write() || refuse(output, "it holds no point and no face");
}

void write_status(int output, WireStatus status, const char* text) {
  WireHeader header;
  header.status = static_cast<std::uint32_t>(status);
  header.text_bytes =
      static_cast<std::uint32_t>(std::min<std::size_t>(std::strlen(text), kMaxWireText));
  if (::write(output, &header, sizeof header) < 0) {
    return;
  }
  if (::write(output, text, header.text_bytes) < 0) {
    return;
  }
}

}  // namespace tactree::builder
