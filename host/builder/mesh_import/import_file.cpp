#include "mesh_import/import_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mesh_import/amf_file.hpp"
#include "mesh_import/collada_check.hpp"
#include "mesh_import/contained_files.hpp"
#include "mesh_import/file_bytes.hpp"
#include "mesh_import/gltf_file.hpp"
#include "mesh_import/gltf_scene.hpp"
#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/scene_notes.hpp"
#include "mesh_import/scene_writer.hpp"
#include "mesh_import/three_mf.hpp"
#include "mesh_import/unit_of_file.hpp"
#include "mesh_import/x3d_check.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kQuotedReason = 160;  // the library may quote half of the file

void configure(Assimp::Importer& importer) {
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_TEXCOORDS | aiComponent_TANGENTS_AND_BITANGENTS |
                                  aiComponent_ANIMATIONS | aiComponent_LIGHTS |
                                  aiComponent_CAMERAS | aiComponent_MATERIALS);
  // Keeps the positions in the frame of the file.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
}

/// The formats of 3ds Max have z up; the library turns them so that y is up.
bool is_turned(std::string_view hint) { return hint == "3ds" || hint == "ase"; }

/// Reads and checks the scene; null on failure.
const aiScene* read_scene(Assimp::Importer& importer, const std::string& file) {
  constexpr unsigned kSteps = aiProcess_ValidateDataStructure | aiProcess_RemoveComponent |
                              aiProcess_Triangulate | aiProcess_JoinIdenticalVertices;
  return importer.ReadFile(file, kSteps);
}

/// Reads a file for which there is a reader in this folder. Returns nullopt if the library must
/// read it.
std::optional<ImportedMesh> read_mesh(const char* file, std::string_view hint) {
  if (hint == "3mf") {
    return read_3mf(file_bytes(file));
  }
  if (hint == "amf") {
    return read_amf(file_bytes(file));
  }
  if (hint == "glb" || hint == "gltf") {
    ContainedFiles files(file, std::string(hint));
    GltfFile gltf(files.alias(), files);
    if (gltf.version() >= 2 && !is_draco_gltf(gltf)) {
      return read_gltf(gltf);
    }
  }
  return std::nullopt;
}

/// Of a file that the library reads.
SceneNotes notes_of_file(const char* file, std::string_view hint) {
  if (hint == "x3d") return check_x3d(file_bytes(file));
  return hint == "dae" ? check_collada(file_bytes(file)) : SceneNotes{};
}

bool refuse(int output, const char* text) {
  write_status(output, WireStatus::kRefused, text);
  return false;
}

}  // namespace

bool import_file(const char* file, const char* hint, int output) {
  SceneNotes notes;
  try {
    if (const std::optional<ImportedMesh> mesh = read_mesh(file, hint)) {
      return write_mesh(*mesh, ::fdopen(output, "wb"));
    }
    notes = notes_of_file(file, hint);
  } catch (const ImportError& error) {
    return refuse(output, error.what());
  }
  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(hint)) {
    return refuse(output, "this version of assimp has no reader for the format");
  }
  configure(importer);
  auto* files = new ContainedFiles(file, hint);
  importer.SetIOHandler(files);  // takes ownership
  const aiScene* scene = read_scene(importer, files->alias());
  if (scene == nullptr) {
    std::string reason = importer.GetErrorString();
    const std::size_t alias = reason.find(files->alias());
    if (alias != std::string::npos) {
      reason.replace(alias, files->alias().size(), file);
    }
    if (reason.size() > kQuotedReason) {
      reason.resize(kQuotedReason);
      reason += " ...";
    }
    return refuse(output, reason.c_str());
  }
  std::FILE* to = ::fdopen(output, "wb");
  FileUnit unit = unit_of_file(*scene, file, hint);
  if (notes.unit_m > 0.0) unit.metres = notes.unit_m;
  SceneWriter writer(*scene, unit, is_turned(hint), std::move(notes.warning), to);
  return writer.write() || refuse(output, "it contains no points and no faces");
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
