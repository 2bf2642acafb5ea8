#pragma once
// An object of an AMF file: the points that its volumes use, and their triangles.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mesh_import/slicer_volumes.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {

using AmfColour = std::array<std::uint8_t, 3>;
using AmfColours = std::map<std::string, AmfColour, std::less<>>;

struct AmfObject {
  std::vector<Eigen::Vector3d> points;
  std::vector<AmfColour> colours;  ///< as many as points, or fewer if points have none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t bad_triangles = 0;  ///< that refer to points that there are not
};

/// Colours of the materials, by their ids.
[[nodiscard]] AmfColours read_materials(pugi::xml_node amf);

/// Counts the volumes that are not the body in `parts`, and leaves them out. Throws ImportError.
[[nodiscard]] AmfObject read_amf_object(pugi::xml_node element, const AmfColours& materials,
                                        NonBodyParts& parts);

}  // namespace tactree::builder
