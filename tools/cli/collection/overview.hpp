#pragma once
// The whole collection in two files: manifest.csv and index.html.

#include <filesystem>
#include <span>
#include <vector>

#include "collection/objects.hpp"
#include "collection/row.hpp"

namespace tactree::cli {

/// The row of each object, in the same order. An object without a row or a blob is "missing".
[[nodiscard]] std::vector<ObjectRow> read_rows(const std::filesystem::path& output,
                                               std::span<const CollectionObject> objects);

/// Writes both files to `output`. The page loads nothing but the pictures beside it. Throws
/// UserError.
void write_overview(const std::filesystem::path& output, std::span<const ObjectRow> rows);

}  // namespace tactree::cli
