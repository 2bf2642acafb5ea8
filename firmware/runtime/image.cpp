// Loop and memory annotations: docs/BOUND.md.

#include "image.hpp"

#include "platform.hpp"
#include "tactree/runtime/memory_test.hpp"

namespace tactree::firmware {
namespace {

bool variables_held = false;

}  // namespace

bool variables_hold() { return variables_held; }

void start_image() {
  prepare_board();
  const bool hold = runtime::holds_all_bits(image_tested_begin, image_tested_end);
  const std::uint32_t* source = image_data_source;
  for (std::uint32_t* to = image_data_begin; to < image_data_end; ++to) {  // bound: data_words
    *to = *source++;
  }
  for (std::uint32_t* to = image_bss_begin; to < image_bss_end; ++to) {  // bound: bss_words
    *to = 0;
  }
  variables_held = hold;
  for (auto constructor = image_constructors_begin; constructor < image_constructors_end;
       ++constructor) {  // bound: constructors
    (*constructor)();
  }
  main();
  tactree_idle();
}

}  // namespace tactree::firmware
