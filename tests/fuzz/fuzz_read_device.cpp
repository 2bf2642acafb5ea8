// Reads arbitrary bytes as a device file: it is refused with a reason, or gives parameters for a
// configuration that do not change when written and read again.

#include "memory_file.hpp"
#include "tactree/core/configuration/configuration.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace {

using namespace tactree;

support::Device read(const fuzz::MemoryFile& file) {
  return support::load_device(file.path().string());
}

void examine(const support::Device& device) {
  core::Configuration configuration;
  configuration.device = device.preset.model;
  const core::ConfigurationStatus status = check(configuration);
  const std::int32_t counts[core::kAxes] = {1000, -1000, 0};
  if (status == core::ConfigurationStatus::kOk) {
    const core::DevicePose pose = locate(configuration.device, counts);
    fuzz::require(!pose.valid || is_finite(pose.probe), "an accepted device is nowhere");
  }
  const std::string written = support::device_json(device);
  const fuzz::MemoryFile again(reinterpret_cast<const std::uint8_t*>(written.data()),
                               written.size());
  fuzz::require(support::device_json(read(again)) == written, "a device changes when it is copied");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  try {
    const support::Device device = read(file);
    try {
      examine(device);
    } catch (const support::UserError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      fuzz::require(false, "a device that was read is refused when it is copied");
    }
  } catch (const support::UserError& error) {
    fuzz::require_reason(error.what(), file.path().string());
  }
  return 0;
}
