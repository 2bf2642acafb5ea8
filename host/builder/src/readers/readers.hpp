#pragma once
// One function per format. Each reads `file` from its first byte and throws ReadError.

#include "input_file.hpp"
#include "recognise.hpp"
#include "remedies.hpp"
#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

[[nodiscard]] Scan read_ply(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_pcd(InputFile& file, const ReadOptions& options);
/// The file is opened again by its `path`, to read the XML section first.
[[nodiscard]] Scan read_e57(InputFile& file, const std::filesystem::path& path,
                            const ReadOptions& options);
/// The file is opened again by its `path`, to read the records behind the points first.
[[nodiscard]] Scan read_las(InputFile& file, const std::filesystem::path& path,
                            const ReadOptions& options);
[[nodiscard]] Scan read_ptx(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_text(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_obj(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_off(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_off_binary(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_stl_ascii(InputFile& file, const ReadOptions& options);
[[nodiscard]] Scan read_stl_binary(InputFile& file, const ReadOptions& options);

/// Reads the file in the mesh import process.
[[nodiscard]] Scan import_mesh(const std::filesystem::path& file, const Recognition& recognition,
                               const ReadOptions& options);

}  // namespace tactree::builder
