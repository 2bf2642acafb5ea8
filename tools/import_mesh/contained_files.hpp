#pragma once
// The files that the mesh library may open: the model, under a name whose extension says what its
// content is, and what lies in its folder or below. Reading only.

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <string>

namespace tactree::import_mesh {

class ContainedFiles : public Assimp::DefaultIOSystem {
 public:
  /// hint: the extension by which the library chooses its reader, e.g. "glb".
  ContainedFiles(const std::filesystem::path& model, const std::string& hint);

  /// The model, under the name to give to the library.
  [[nodiscard]] const std::string& alias() const { return alias_; }

  bool Exists(const char* name) const override;
  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  /// The real path, or empty when the name is out of bounds.
  [[nodiscard]] std::string real_path(const std::string& name) const;

  std::filesystem::path model_;
  std::filesystem::path folder_;
  std::string alias_;
};

}  // namespace tactree::import_mesh
