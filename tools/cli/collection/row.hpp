#pragma once
// The result of one object: a JSON file beside its blob. Each is written by one process, so several
// may share a folder without locks.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "collection/objects.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::cli {

/// Values of "result". A blob of ambiguous orientation is complete, but should be looked at.
inline constexpr const char* kResultOk = "ok";
inline constexpr const char* kResultAmbiguous = "ambiguous";
inline constexpr const char* kResultFailed = "failed";
/// Only in the manifest: there is no row, or no blob.
inline constexpr const char* kResultMissing = "missing";

/// Files of an object, named after the whole name of the scan.
struct ObjectFiles {
  ObjectFiles(const std::filesystem::path& output, const CollectionObject& object);

  std::filesystem::path blob;     ///< NAME.blob
  std::filesystem::path preview;  ///< NAME.png
  std::filesystem::path row;      ///< NAME.json
};

/// A row for `manifest.csv`, whose columns are its keys, and the "report" of the build.
using ObjectRow = nlohmann::ordered_json;

[[nodiscard]] ObjectRow row_of_failure(const CollectionObject& object, const std::string& digest,
                                       const std::string& error);
/// `digest` is that of the object, `blob_digest` that of its blob.
[[nodiscard]] ObjectRow row_of_build(const CollectionObject& object, const std::string& digest,
                                     const std::string& blob_digest,
                                     const builder::BuildReport& report,
                                     const builder::BuildOptions& build);

/// Nullopt if there is no row, or if it is damaged.
[[nodiscard]] std::optional<ObjectRow> read_row(const ObjectFiles& files);

/// The text of a key; empty if the row does not have it.
[[nodiscard]] std::string text_of(const ObjectRow& row, const char* key);

}  // namespace tactree::cli
