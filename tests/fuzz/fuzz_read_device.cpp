// Reads arbitrary bytes as a device file: it is refused with a reason, or gives parameters for a
// configuration that do not change when written and read again.

#include "command.hpp"
#include "device_file.hpp"
#include "memory_file.hpp"
#include "tactree/core/configuration/configuration.hpp"

namespace {

using namespace tactree;

cli::Device read(const fuzz::MemoryFile& file) { return cli::load_device(file.path().string()); }

void examine(const cli::Device& device) {
  core::Configuration configuration;
  configuration.device = device.preset.model;
  const core::ConfigurationStatus status = check(configuration);
  const std::int32_t counts[core::kAxes] = {1000, -1000, 0};
  if (status == core::ConfigurationStatus::kOk) {
    const core::DevicePose pose = locate(configuration.device, counts);
    fuzz::require(!pose.valid || is_finite(pose.probe), "an accepted device is nowhere");
  }
  const std::string written = cli::device_json(device);
  const fuzz::MemoryFile again(reinterpret_cast<const std::uint8_t*>(written.data()),
                               written.size());
  fuzz::require(cli::device_json(read(again)) == written, "a device changes when it is copied");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  try {
    const cli::Device device = read(file);
    try {
      examine(device);
    } catch (const cli::CommandError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      fuzz::require(false, "a device that was read is refused when it is copied");
    }
  } catch (const cli::CommandError& error) {
    fuzz::require_reason(error.what(), file.path().string());
  }
  return 0;
}
