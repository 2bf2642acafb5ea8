#pragma once
// The result of a board's start: whether a model can be rendered, and otherwise the cause.
// Interrupt safe: plain data, pure functions of constant cost.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::hal {

/// The self-test of the firmware image.
enum class ImageStatus : std::uint8_t {
  kOk = 0,
  kDamaged,    ///< the checksum of the program is wrong
  kBadMemory,  ///< the RAM self-test failed
};

struct StartResult {
  core::ConfigurationStatus configuration = core::ConfigurationStatus::kOk;
  core::BlobStatus blob = core::BlobStatus::kOk;
  core::ModelStatus model = core::ModelStatus::kOk;
  ImageStatus image = ImageStatus::kOk;  ///< set by the firmware, ahead of Loop::start()
  [[nodiscard]] bool ok() const {
    return configuration == core::ConfigurationStatus::kOk && blob == core::BlobStatus::kOk &&
           model == core::ModelStatus::kOk && image == ImageStatus::kOk;
  }
};

/// Describes the first failure, in the order of the start: image, configuration, blob, model.
[[nodiscard]] inline const char* describe(const StartResult& start) {
  if (start.image != ImageStatus::kOk) {
    return start.image == ImageStatus::kBadMemory ? "RAM self-test failed"
                                                  : "the checksum of the program is wrong";
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    return core::describe(start.configuration);
  }
  return start.blob != core::BlobStatus::kOk ? core::describe(start.blob)
                                             : core::describe(start.model);
}

}  // namespace tactree::hal
