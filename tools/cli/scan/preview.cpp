#include "scan/preview.hpp"

#include <vector>

#include "tactree/picture/model_picture.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {

void write_preview(const std::filesystem::path& file, const core::BlobView& view,
                   std::span<const builder::Opening> openings,
                   std::span<const std::uint8_t> doubtful) {
  std::vector<picture::Mark> marks;
  for (const builder::Opening& opening : openings) {
    const Eigen::Vector3f centre = opening.centre.cast<float>();
    marks.push_back({{centre.x(), centre.y(), centre.z()},
                     static_cast<float>(opening.diameter_m),
                     opening.kind == builder::Opening::Kind::kHole});
  }
  const std::vector<std::byte> png = picture::draw_model(view, marks, doubtful).png();
  support::write_file(file, std::span<const std::byte>(png));
}

}  // namespace tactree::cli
