#pragma once
// What a user can do about a damaged file, or one without a reader: the same words everywhere.

namespace tactree::builder {

inline constexpr const char* kExportAgain = "export the scan again";
/// Of missing or wrong bytes.
inline constexpr const char* kCopyAgain =
    "the file was cut off or is damaged; copy or export it again";
/// Of wrong text.
inline constexpr const char* kCopyDamaged = "the file is damaged; copy or export it again";

// Of files without a reader.
inline constexpr const char* kMeshToPly =
    "convert it with `meshio convert FILE scan.ply`, or open it in ParaView or Gmsh and save its "
    "surface as PLY or STL";
inline constexpr const char* kSurfaceToPly =
    "open it in CloudCompare or MeshLab and save it as PLY";
inline constexpr const char* kGridToXyz =
    "convert it to points with `gdal_translate -of XYZ FILE scan.xyz`";
inline constexpr const char* kCadToStl = "export it from the CAD program as STL or PLY";
inline constexpr const char* kNotAScan = "give the scan file";

}  // namespace tactree::builder
