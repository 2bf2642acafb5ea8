#include "mesh_import/contained_files.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace tactree::builder {

namespace fs = std::filesystem;

ContainedFiles::ContainedFiles(const fs::path& model, const std::string& hint)
    : model_(fs::absolute(model)), folder_(fs::weakly_canonical(model_.parent_path())) {
  alias_ = (model_.parent_path() / ("model-by-content." + hint)).string();
}

std::string ContainedFiles::real_path(const std::string& name) const {
  if (name == alias_) return model_.string();
  std::error_code error;
  fs::path path(name);
  if (path.is_relative()) path = folder_ / path;
  path = fs::weakly_canonical(path, error);  // follows links
  if (error || !fs::is_regular_file(path, error)) return {};
  const auto [inside, rest] =
      std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end());
  (void)rest;
  return inside == folder_.end() ? path.string() : std::string{};
}

bool ContainedFiles::Exists(const char* name) const { return !real_path(name).empty(); }

Assimp::IOStream* ContainedFiles::Open(const char* name, const char* mode) {
  if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
  const std::string path = real_path(name);
  return path.empty() ? nullptr : DefaultIOSystem::Open(path.c_str(), mode);
}

}  // namespace tactree::builder
