#pragma once
// Output files that are written completely or not at all.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace tactree::support {

/// Call before any work. Refuses an output that cannot be written, that is also an input, or that
/// is named twice. An empty path is an output that is not wanted. Throws UserError.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs = {});

/// Writes a temporary file beside `file`, flushes it to the disk and renames it. On failure no
/// temporary file remains and an existing file is unchanged. A device or pipe is written in place.
/// Throws UserError.
void write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

}  // namespace tactree::support
