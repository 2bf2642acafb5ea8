#pragma once
// Which board an image is for, and where it and its blob may lie: in the image itself, so that
// tools refuse to flash the wrong one (scripts/make-image).

#include <cstddef>
#include <cstdint>

namespace tactree::firmware {

struct Identity {
  char mark[8];    ///< "TACTIMG"
  char board[24];  ///< folder in boards/, zero-terminated
  const std::byte* code_begin;
  const std::byte* code_end;
  const std::byte* blob_begin;
  const std::byte* blob_end;
};

[[gnu::section(".identity")]] extern const Identity kIdentity;

}  // namespace tactree::firmware
