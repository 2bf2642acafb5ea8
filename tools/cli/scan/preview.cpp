#include "scan/preview.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "tactree/picture/model_picture.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {

namespace {

/// Empty for a model with fewer than two materials.
std::vector<picture::MaterialKey> material_keys(const core::BlobView& view,
                                                const std::optional<builder::MaterialMap>& named) {
  std::vector<picture::MaterialKey> keys;
  for (std::uint32_t i = 0; i < view.material_count() && view.material_count() > 1; ++i) {
    const float stiffness_N_m = view.material(i).stiffness_N_m;
    const std::string name =
        named ? builder::material_name(*named, i) : fmt::format("material {}", i);
    picture::Colour colour = picture::false_colour(i);
    if (named && i > 0) {
      const builder::Colour& scan = named->colours[i - 1].colour;
      colour = {static_cast<float>(scan[0]) / 255.0F, static_cast<float>(scan[1]) / 255.0F,
                static_cast<float>(scan[2]) / 255.0F};
    }
    keys.push_back({colour, fmt::format("{}, {:.6g} N/m", name, stiffness_N_m)});
  }
  return keys;
}

}  // namespace

void write_preview(const std::filesystem::path& file, const core::BlobView& view,
                   std::span<const builder::Opening> openings,
                   std::span<const std::uint8_t> doubtful,
                   const std::optional<builder::MaterialMap>& named,
                   std::span<const builder::Colour> colours) {
  std::vector<picture::Mark> marks;
  for (const builder::Opening& opening : openings) {
    const Eigen::Vector3f centre = opening.centre.cast<float>();
    marks.push_back({{centre.x(), centre.y(), centre.z()},
                     static_cast<float>(opening.diameter_m),
                     opening.kind == builder::Opening::Kind::kHole});
  }
  const std::vector<std::byte> png =
      picture::draw_model(view, marks, doubtful, material_keys(view, named), colours).png();
  support::write_file(file, std::span<const std::byte>(png));
}

}  // namespace tactree::cli
