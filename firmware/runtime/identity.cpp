// Compiled once per image; the build defines the board.

#include "runtime/identity.hpp"

#include <cstddef>

#include "runtime/image.hpp"
#include "tactree/core/math/crc32.hpp"

namespace tactree::firmware {

static_assert(sizeof(Identity) == 56);
static_assert(offsetof(Identity, checksum) + 4 == sizeof(Identity));

[[gnu::used]] const Identity kIdentity = {"TACTIMG",  TACTREE_BOARD, code_begin, code_end,
                                          blob_begin, blob_end,      uf2_family, 0};

hal::ImageStatus test_image() {
  if (!variables_hold()) {
    return hal::ImageStatus::kBadMemory;
  }
  // The compiler must not fold the constant: seal-image changes it after the build.
  const volatile Identity* const sealed = &kIdentity;
  const auto* const end = reinterpret_cast<const std::byte*>(&kIdentity) + sizeof kIdentity - 4;
  core::Crc32 checksum;
  checksum.update({image_vectors_begin, image_vectors_end});
  checksum.update({image_text_begin, end});  // the executed code, which may be a copy in RAM
  checksum.update({reinterpret_cast<const std::byte*>(image_data_source),
                   static_cast<std::size_t>(image_data_end - image_data_begin) * 4U});
  checksum.update({image_slow_begin, image_slow_end});
  return checksum.value() == sealed->checksum ? hal::ImageStatus::kOk : hal::ImageStatus::kDamaged;
}

}  // namespace tactree::firmware
