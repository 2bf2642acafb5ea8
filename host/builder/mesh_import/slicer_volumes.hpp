#pragma once
// The parts of a 3MF or AMF that are not the body: modifiers, supports and what is not printed.
// Core files mark them by the type of an object; slicers mark them in files of their own.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "mesh_import/three_mf_model.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {

inline constexpr const char* kSlic3rVolumes = "Metadata/Slic3r_PE_model.config";
inline constexpr const char* kOrcaVolumes = "Metadata/model_settings.config";

/// Numbers of parts by their kind, such as "modifier".
struct NonBodyParts {
  std::map<std::string, std::size_t, std::less<>> left_out;
  std::map<std::string, std::size_t, std::less<>> kept;    ///< that may not belong to the body
  std::map<std::string, std::size_t, std::less<>> unread;  ///< shapes that are not meshes

  /// Sentences for a warning; empty if there is nothing to tell.
  [[nodiscard]] std::string text() const;
};

/// What a slicer calls the object of a type; empty if it is the body.
[[nodiscard]] std::string_view kind_of_type(std::string_view type);

/// The same for a volume of a slicer. An unknown type is the body, and counted in `parts`.
[[nodiscard]] std::string_view kind_of_volume(std::string_view type, NonBodyParts& parts);

/// Removes the triangles of the volumes in `settings`, the file kSlic3rVolumes of PrusaSlicer. They
/// are ranges of the triangles of an object. Throws ImportError.
void remove_slic3r_volumes(const XmlDocument& settings, ModelPart& root, NonBodyParts& parts);

/// Removes the components of the parts in `settings`, the file kOrcaVolumes of Bambu Studio and
/// OrcaSlicer.
void remove_orca_volumes(const XmlDocument& settings, ModelPart& root, NonBodyParts& parts);

}  // namespace tactree::builder
