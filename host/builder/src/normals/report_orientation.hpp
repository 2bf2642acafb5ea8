#pragma once
// Summarises the orientation of a cloud or mesh for the user.

#include "normals/mesh_windings.hpp"
#include "normals/orient_cloud.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Fills report.orientation, and adds a warning if the orientation of a part of the surface is
/// ambiguous or if normals of the file were reversed.
void report_orientation(const CloudOrientation& orientation, std::uint64_t reversed_normals,
                        BuildReport& report);

/// Fills report.orientation for a mesh of `faces` faces, and adds such warnings.
void report_windings(const WindingRepair& repair, std::uint64_t faces, BuildReport& report);

}  // namespace tactree::builder
