#pragma once
// The board of an image, and the address ranges of code and blob, stored in the image itself:
// `tactree image` refuses a blob or board that does not fit. tools/cli reads it.

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
  const std::byte* uf2_family;  ///< number of the chip in UF2 files, not an address; 0: none
  std::uint32_t checksum;       ///< of the image, filled in by scripts/seal-image: test_image()
};

/// The last bytes of the code.
[[gnu::section(".identity")]] extern const Identity kIdentity;

/// Checks the result of the RAM test and the checksum of the program: vectors and code up to the
/// checksum, then initial values of variables. Cost: about 10 instructions per byte.
[[nodiscard]] hal::ImageStatus test_image();

}  // namespace tactree::firmware
