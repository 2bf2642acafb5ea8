// Compiled once for each image; the build says for which board.

#include "runtime/identity.hpp"

#include "runtime/image.hpp"

namespace tactree::firmware {

static_assert(sizeof(Identity) == 56);

[[gnu::used]] const Identity kIdentity = {"TACTIMG",  TACTREE_BOARD, code_begin, code_end,
                                          blob_begin, blob_end,      uf2_family, 0};

}  // namespace tactree::firmware
