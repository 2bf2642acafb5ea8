#include "image.hpp"

#include "platform.hpp"

namespace tactree::firmware {

void start_image() {
  prepare_board();
  const std::uint32_t* source = image_data_source;
  for (std::uint32_t* to = image_data_begin; to < image_data_end; ++to) {  // bound: data_words
    *to = *source++;
  }
  for (std::uint32_t* to = image_bss_begin; to < image_bss_end; ++to) {  // bound: bss_words
    *to = 0;
  }
  for (auto constructor = image_constructors_begin; constructor < image_constructors_end;
       ++constructor) {  // bound: constructors
    (*constructor)();
  }
  main();
  tactree_idle();
}

}  // namespace tactree::firmware
