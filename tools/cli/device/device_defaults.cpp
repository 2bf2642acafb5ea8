#include "device/device_defaults.hpp"

#include <fmt/core.h>

namespace tactree::cli {

void note_defaults(const std::string& file, const support::Device& device) {
  if (const std::string used = support::defaults_text(device); !used.empty()) {
    fmt::print(stderr, "tactree: note: {}: defaults: {} (`tactree device check` explains them)\n",
               file, used);
  }
}

}  // namespace tactree::cli
