#pragma once
// Digests that tell whether an object must be built again. All are SHA-256, in hexadecimal.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

namespace tactree::cli {

/// Digest of the bytes of a file. Anything but a readable regular file counts as empty, because
/// the build refuses it.
[[nodiscard]] std::string digest_of_file(const std::filesystem::path& file);

/// Digest of the version of the program, and of all given options of `build` that determine a
/// blob, with the contents of the files that they name.
[[nodiscard]] std::string digest_of_options(const CLI::App& build);

/// Digest of the options and of a scan, with the files of a glTF's buffers.
[[nodiscard]] std::string digest_of_object(const std::string& options,
                                           const std::filesystem::path& scan);

}  // namespace tactree::cli
