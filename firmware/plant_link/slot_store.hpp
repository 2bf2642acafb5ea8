#pragma once
// The model store of an emulated board.

#include "plant_link/ram_flash.hpp"
#include "runtime/blob_area.hpp"
#include "tactree/store/model_store.hpp"

namespace tactree::firmware {

/// Slots in RamFlash. The model of the image is used until a slot is activated.
class SlotStore : public store::ModelStore<RamFlash> {
 public:
  explicit SlotStore(const char* board) : ModelStore(flash_, {board, nullptr, {}}) {}

  /// Call once at start-up, before other functions. `factory` is the model of the image.
  void prepare(const BlobArea& factory) {
    flash_.prepare();
    set_factory(factory.active());
    (void)mount();
  }

 private:
  RamFlash flash_;
};

}  // namespace tactree::firmware
