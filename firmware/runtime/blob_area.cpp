#include "runtime/blob_area.hpp"

#include "runtime/image.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::firmware {

std::span<const std::byte> BlobArea::active() const noexcept {
  const auto area = static_cast<std::size_t>(blob_end - blob_begin);
  const auto& header = *reinterpret_cast<const core::BlobHeader*>(blob_begin);
  return {blob_begin, header.total_bytes < area ? header.total_bytes : area};
}

}  // namespace tactree::firmware
