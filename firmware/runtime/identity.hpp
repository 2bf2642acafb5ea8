#pragma once
// The board of an image and the address ranges of code and blob, stored in the image itself.
// `tactree image` (tools/cli) reads them and refuses a blob or a board that does not fit.

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
  const std::byte* uf2_family;  ///< UF2 family ID, not an address; 0: none
  std::uint32_t checksum;  ///< of the image; written by scripts/seal-image, checked by test_image()
};

/// Placed at the end of the code.
[[gnu::section(".identity")]] extern const Identity kIdentity;

/// Checks the result of the RAM test and the checksum of the program: vectors, code up to the
/// checksum, initial values of variables, and code that runs from flash only. Cost: about 10
/// instructions per byte.
[[nodiscard]] hal::ImageStatus test_image();

}  // namespace tactree::firmware
