#pragma once
// Where an emulated board keeps models that an application writes.

#include "plant_link/ram_flash.hpp"
#include "runtime/blob_area.hpp"
#include "tactree/hal/store/model_store.hpp"

namespace tactree::firmware {

/// Slots in RamFlash. Until one is written the model is that of the image.
class SlotStore : public hal::ModelStore<RamFlash> {
 public:
  explicit SlotStore(const char* board) : ModelStore(flash_, {board, nullptr, {}}) {}

  void prepare(const BlobArea& factory) {
    flash_.prepare();
    set_factory(factory.active());
    (void)mount();
  }

 private:
  RamFlash flash_;
};

}  // namespace tactree::firmware
