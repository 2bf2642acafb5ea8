// Reads arbitrary bytes as a 3MF, AMF or glTF file, and as the document of a COLLADA or X3D scene,
// by the readers of the import process: each is refused with a cause, or gives a usable mesh. What
// the library assimp reads is not executed. A document of a 3MF is put into an archive with the
// checksums that a fuzzer cannot guess.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "memory_file.hpp"
#include "mesh_import/amf_file.hpp"
#include "mesh_import/collada_check.hpp"
#include "mesh_import/contained_files.hpp"
#include "mesh_import/gltf_file.hpp"
#include "mesh_import/gltf_scene.hpp"
#include "mesh_import/three_mf.hpp"
#include "mesh_import/x3d_check.hpp"
#include "mesh_writers.hpp"

namespace {

using namespace tactree::builder;
using tactree::fuzz::Folder;
using tactree::fuzz::require;

void examine(const ImportedMesh& mesh) {
  const std::size_t points = mesh.positions.size();
  require(mesh.normals.empty() || mesh.normals.size() == points, "not one normal a point");
  require(mesh.colours.empty() || mesh.colours.size() == points, "not one colour a point");
  require(!std::isnan(mesh.unit_m) && mesh.unit_m >= 0.0, "a unit that is no length");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      require(corner < points, "a triangle names a point that does not exist");
    }
  }
}

void examine(const SceneNotes& notes) {
  require(!std::isnan(notes.unit_m) && notes.unit_m >= 0.0, "a unit that is no length");
}

/// Reads by one reader.
template <typename Read>
void attempt(Read&& read) {
  try {
    examine(read());
  } catch (const ImportError& error) {
    require(std::string_view(error.what()).size() > 10, "a refusal without a cause");
  }
}

ImportedMesh read_gltf_text(std::string_view bytes) {
  static const Folder folder;
  const std::filesystem::path file = folder.path() / "scene.gltf";
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  ContainedFiles files(file, "gltf");
  GltfFile gltf(files.alias(), files);
  return gltf.version() >= 2 && !is_draco_gltf(gltf) ? read_gltf(gltf) : ImportedMesh{};
}

std::string archive_of(const std::string& document) {
  constexpr const char* kRelations =
      R"(<Relationships><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
  return tactree::test::ZipWriter(true)
      .add("_rels/.rels", kRelations)
      .add("3D/3dmodel.model", document)
      .bytes();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.starts_with("PK")) {
    attempt([&] { return read_3mf(text); });
  } else if (text.find("<model") != std::string::npos) {
    attempt([&] { return read_3mf(archive_of(text)); });
  } else if (text.find("<amf") != std::string::npos) {
    attempt([&] { return read_amf(text); });
  } else if (text.find('<') != std::string::npos) {
    attempt([&] { return check_collada(text); });
    attempt([&] { return check_x3d(text); });
  } else {
    attempt([&] { return read_gltf_text(text); });
  }
  return 0;
}
