#pragma once
// The scans of a collection: those that a list names, or those below a folder.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tactree::cli {

/// One scan, which becomes one blob.
struct CollectionObject {
  /// Unique in the collection: the path of the scan relative to the list or folder. Of a scan that
  /// is elsewhere, its absolute path without the leading slash.
  std::string name;
  std::filesystem::path input;
};

struct Collection {
  std::vector<CollectionObject> objects;  ///< sorted by name, so that every process has one order
  std::size_t left_out = 0;               ///< files of a folder without the extension of a scan
};

/// Reads a list, a text file with one path per line, or finds the scans below a folder, without
/// those in `output`. Throws UserError if there are none, or if two have the same name.
[[nodiscard]] Collection read_collection(const std::filesystem::path& place,
                                         const std::filesystem::path& output);

}  // namespace tactree::cli
