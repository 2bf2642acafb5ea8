#pragma once
// Checks of the XML document of a scene that assimp reads.

#include <cstddef>
#include <string>
#include <utility>

#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/scene_notes.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {

inline constexpr XmlLimits kSceneLimits{std::size_t{1} << 30, 16'000'000, 1000};

/// What `check` says of the root of the document. A malformed document has no notes: assimp names
/// the fault. Throws ImportError if it is too large.
template <typename Check>
SceneNotes notes_of_document(std::string text, Check&& check) {
  try {
    const XmlDocument document(std::move(text), kSceneLimits);
    return check(document.root());
  } catch (const XmlTooLarge& error) {
    throw ImportError("it is too large: " + std::string(error.what()));
  } catch (const XmlError&) {
    return {};
  }
}

}  // namespace tactree::builder
