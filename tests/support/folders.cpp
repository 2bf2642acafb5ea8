#include "folders.hpp"

namespace tactree::test {

std::filesystem::path source_folder() { return TACTREE_SOURCE_FOLDER; }
std::filesystem::path build_folder() { return TACTREE_BUILD_FOLDER; }
std::filesystem::path scans_folder() { return TACTREE_SCANS_FOLDER; }

}  // namespace tactree::test
