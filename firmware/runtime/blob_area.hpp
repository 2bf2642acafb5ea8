#pragma once
// The blob at its fixed place in flash.

#include <cstddef>
#include <span>

namespace tactree::firmware {

class BlobArea {
 public:
  /// The header tells the size; open_blob() finds out when that is a lie.
  [[nodiscard]] std::span<const std::byte> active() const noexcept;
};

}  // namespace tactree::firmware
