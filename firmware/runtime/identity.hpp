#pragma once
// Which board an image is for, and where it and its blob may lie: in the image itself, so that
// `tactree image` can refuse the wrong one. tools/cli/firmware_image.hpp reads it.

#include <cstddef>
#include <cstdint>

#include "tactree/hal/loop.hpp"

namespace tactree::firmware {

struct Identity {
  char mark[8];    ///< "TACTIMG"
  char board[24];  ///< folder in boards/, zero-terminated
  const std::byte* code_begin;
  const std::byte* code_end;
  const std::byte* blob_begin;
  const std::byte* blob_end;
  const std::byte* uf2_family;  ///< a number, not a place: of the chip, in UF2 files; 0: none
  std::uint32_t checksum;       ///< of the image, filled in by scripts/seal-image: test_image()
};

/// The last bytes of the code.
[[gnu::section(".identity")]] extern const Identity kIdentity;

/// Did the memory of all variables hold, and is every byte of the program as it was built: of the
/// vectors and the code up to the checksum, then of the initial values of variables? Cost: some 10
/// instructions a byte.
[[nodiscard]] hal::ImageStatus test_image();

}  // namespace tactree::firmware
