#pragma once
// Sums up the orientation of a cloud for the user.

#include "normals/mesh_windings.hpp"
#include "normals/orient_cloud.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Fills report.orientation, and adds a warning if a part of the surface is doubtful or normals of
/// the file were reversed.
void report_orientation(const CloudOrientation& orientation, std::uint64_t reversed_normals,
                        BuildReport& report);

/// The same for a mesh of `faces` faces.
void report_windings(const WindingRepair& repair, std::uint64_t faces, BuildReport& report);

}  // namespace tactree::builder
