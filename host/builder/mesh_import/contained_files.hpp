#pragma once
// Restricts the mesh library to the files in and below the folder of the model, read only. The
// model gets an alias whose extension matches its content.

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <string>

namespace tactree::builder {

class ContainedFiles : public Assimp::DefaultIOSystem {
 public:
  /// hint: extension that selects the reader of the library, e.g. "glb".
  ContainedFiles(const std::filesystem::path& model, const std::string& hint);

  /// Name of the model for the library.
  [[nodiscard]] const std::string& alias() const { return alias_; }

  bool Exists(const char* name) const override;
  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  /// The canonical path, or empty if it is outside the folder.
  [[nodiscard]] std::string real_path(const std::string& name) const;

  std::filesystem::path model_;
  std::filesystem::path folder_;
  std::string alias_;
};

}  // namespace tactree::builder
