#pragma once
// The blob at its fixed address in flash.

#include <cstddef>
#include <span>

namespace tactree::firmware {

class BlobArea {
 public:
  /// The blob. Its size is read from its header and limited to the area; open_blob() checks it.
  [[nodiscard]] std::span<const std::byte> active() const noexcept;
};

}  // namespace tactree::firmware
