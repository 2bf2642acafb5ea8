// Reads arbitrary bytes as a material file or as a list of properties: it is refused with a reason
// or gives materials that a blob may hold.

#include "memory_file.hpp"
#include "tactree/builder/read_materials.hpp"
#include "tactree/builder/scan.hpp"

namespace {

using namespace tactree;

bool in_range(float v, float low, float high) { return v >= low && v <= high; }

void examine(const builder::MaterialMap& map) {
  const std::vector<core::BlobMaterial> list = map.list();
  fuzz::require(!list.empty() && list.size() <= core::kMaxMaterials, "no or too many materials");
  for (const core::BlobMaterial& m : list) {
    const bool good =
        in_range(m.stiffness_N_m, 0.0F, 1e6F) && in_range(m.damping_Ns_m, 0.0F, 1e4F) &&
        in_range(m.static_friction, 0.0F, 4.0F) &&
        in_range(m.dynamic_friction, 0.0F, m.static_friction) &&
        in_range(m.texture_height_m, 0.0F, 1.0F) && in_range(m.texture_wavelength_m, 0.0F, 1e3F);
    fuzz::require(good, "a material that open_blob() would refuse");
  }
  for (const builder::Colour colour : {builder::Colour{0, 0, 0}, builder::Colour{255, 10, 0}}) {
    fuzz::require(map.index_of(colour) < list.size(), "a colour without a material");
  }
}

}  // namespace

// A first byte of '=' is the option itself, anything else a file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  const bool is_option = size > 0 && data[0] == '=';
  const std::string option =
      is_option ? "stiffness=" + std::string(reinterpret_cast<const char*>(data) + 1, size - 1)
                : file.path().string();
  if (option.find('\0') != std::string::npos) {
    return 0;  // no argument holds a zero byte
  }
  try {
    examine(builder::read_materials(option));
  } catch (const builder::ReadError& error) {
    fuzz::require_reason(error.what(), is_option ? "--material" : option);
  }
  return 0;
}
