#include "scan/named_materials.hpp"

#include <fmt/format.h>

#include <vector>

#include "tactree/builder/read_materials.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

bool is_same(const core::BlobMaterial& a, const core::BlobMaterial& b) {
  return a.stiffness_N_m == b.stiffness_N_m && a.damping_Ns_m == b.damping_Ns_m &&
         a.static_friction == b.static_friction && a.dynamic_friction == b.dynamic_friction &&
         a.texture_height_m == b.texture_height_m &&
         a.texture_wavelength_m == b.texture_wavelength_m;
}

}  // namespace

std::optional<builder::MaterialMap> named_materials(const std::string& file,
                                                    const std::string& blob,
                                                    const core::BlobView& view) {
  if (file.empty()) {
    return std::nullopt;
  }
  builder::MaterialMap map = builder::read_materials(file);
  const std::vector<core::BlobMaterial> list = map.list();
  const std::string remedy = "give the file with which the model was built";
  if (list.size() != view.material_count()) {
    support::refuse(
        file,
        fmt::format("describes {} materials, {} has {}", list.size(), blob, view.material_count()),
        remedy);
  }
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    if (!is_same(list[i], view.material(i))) {
      support::refuse(file,
                      fmt::format("the material '{}' has other values than material {} of {}",
                                  builder::material_name(map, i), i, blob),
                      remedy);
    }
  }
  return map;
}

}  // namespace tactree::cli
