// Reads arbitrary bytes as a scene file: it is refused with a reason, or gives bodies that a
// controller accepts at every time.

#include <cstdlib>
#include <fstream>

#include "folders.hpp"
#include "memory_file.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/support/user_error.hpp"

namespace {

using namespace tactree;
namespace fs = std::filesystem;

// A separate folder: file names in the scene must not resolve to descriptors of this process, some
// of which block.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "tactree-scene-XXXXXX").string();
    fuzz::require(::mkdtemp(name.data()) != nullptr, "no folder can be made");
    path_ = name;
    fs::copy_file(test::seeds_folder() / "open_blob/kOk.surface", path_ / "a.blob");
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void examine(const setup::SceneFile& scene) {
  fuzz::require(!scene.bodies.empty() && scene.bodies.size() <= core::kMaxBodies,
                "no or too many bodies");
  fuzz::require(
      scene.names.size() == scene.bodies.size() && scene.files.size() == scene.bodies.size(),
      "a body without a blob");
  for (const simulation::SceneBody& body : scene.bodies) {
    fuzz::require(!body.blob.empty(), "a body without bytes");
    const core::Pose first = body.path.at(0.0).pose;
    fuzz::require(is_valid(first), "a pose that the controller refuses");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  const fs::path file = folder.path() / "scene.json";
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    examine(setup::read_scene(file, {(folder.path() / "a.blob").string()}));
  } catch (const support::UserError& error) {
    fuzz::require_reason(error.what(), folder.path().string());
  }
  return 0;
}
