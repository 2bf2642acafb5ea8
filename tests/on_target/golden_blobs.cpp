#include "golden_blobs.hpp"

#define TACTREE_FILE(symbol, name)           \
  __asm(".pushsection .rodata." #symbol      \
        ",\"a\"\n"                           \
        ".balign 4\n"                        \
        ".global " #symbol "\n" #symbol      \
        ":\n"                                \
        ".incbin \"" TACTREE_GOLDEN "/" name \
        "\"\n"                               \
        ".global " #symbol "_end\n" #symbol  \
        "_end:\n"                            \
        ".popsection\n")

TACTREE_FILE(golden_surface, "surface-1.0.blob");
TACTREE_FILE(golden_paper, "paper-1.0.blob");

extern "C" {
extern const std::byte golden_surface[];
extern const std::byte golden_surface_end[];
extern const std::byte golden_paper[];
extern const std::byte golden_paper_end[];
}

namespace tactree::test {

std::span<const std::byte> golden(Golden which) {
  return which == Golden::kSurface ? std::span(golden_surface, golden_surface_end)
                                   : std::span(golden_paper, golden_paper_end);
}

}  // namespace tactree::test
