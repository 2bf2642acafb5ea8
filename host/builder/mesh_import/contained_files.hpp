#pragma once
// Restricts the mesh library to read-only access to the files in and below the folder of the model.
// The library selects its reader by the extension, so the model gets an alias whose extension
// matches its content.

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <string>

namespace tactree::builder {

class ContainedFiles : public Assimp::DefaultIOSystem {
 public:
  /// `hint` is the extension that selects the reader of the library, e.g. "glb".
  ContainedFiles(const std::filesystem::path& model, const std::string& hint);

  /// Name of the model for the library.
  [[nodiscard]] const std::string& alias() const { return alias_; }

  bool Exists(const char* name) const override;
  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  /// Returns the canonical path, or an empty string if it is outside the folder.
  [[nodiscard]] std::string real_path(const std::string& name) const;

  std::filesystem::path model_;
  std::filesystem::path folder_;
  std::string alias_;
};

}  // namespace tactree::builder
