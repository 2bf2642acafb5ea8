#pragma once
// Where an emulated board keeps models that an application writes: in slots, or not at all.

#include <cstdint>
#include <span>

#include "plant_link/ram_flash.hpp"
#include "runtime/blob_area.hpp"
#include "tactree/hal/store/model_store.hpp"
#include "tactree/hal/store/no_model_store.hpp"

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

/// The model is that of the image.
class ImageStore : public hal::NoModelStore {
 public:
  explicit ImageStore(const char*) {}
  void prepare(const BlobArea& factory) { factory_ = factory.active(); }
  [[nodiscard]] std::span<const std::byte> active() const noexcept { return factory_; }
  [[nodiscard]] static const float* parameters() { return nullptr; }

 private:
  std::span<const std::byte> factory_;
};

}  // namespace tactree::firmware
