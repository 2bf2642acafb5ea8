#pragma once
// Folders of the project for tests. Only one small file is compiled with their paths, so that a
// compiler cache finds all others again in another folder.

#include <filesystem>

namespace tactree::test {

/// Of the sources, with README.md.
[[nodiscard]] std::filesystem::path source_folder();
/// Of this build.
[[nodiscard]] std::filesystem::path build_folder();
/// Of real scans, outside of the project; it may not exist.
[[nodiscard]] std::filesystem::path scans_folder();
/// Of the fuzzing seeds, which are made by the build.
[[nodiscard]] inline std::filesystem::path seeds_folder() {
  return build_folder() / "tests/fuzz/seeds";
}

}  // namespace tactree::test
