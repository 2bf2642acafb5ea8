#pragma once
// Files the verbs write appear whole or not at all.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace tactree::cli {

/// Writes beside `file`, flushes to the disk, renames. On failure nothing is left behind and an
/// existing file is untouched. Throws CommandError.
void write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace tactree::cli
