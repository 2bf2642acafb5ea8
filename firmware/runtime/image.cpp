#include "image.hpp"

#include "platform.hpp"

namespace tactree::firmware {

void start_image() {
  prepare_board();
  const std::uint32_t* source = image_data_source;
  for (std::uint32_t* to = image_data_begin; to < image_data_end; ++to) {
    *to = *source++;
  }
  for (std::uint32_t* to = image_bss_begin; to < image_bss_end; ++to) {
    *to = 0;
  }
  for (auto constructor = image_constructors_begin; constructor < image_constructors_end;
       ++constructor) {
    (*constructor)();
  }
  main();
  tactree_idle();
}

}  // namespace tactree::firmware
