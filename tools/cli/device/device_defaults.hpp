#pragma once
// Values that a device file does not state.

#include <string>

#include "tactree/support/device_file.hpp"

namespace tactree::cli {

/// Prints the defaults in use on standard error; nothing if the file states all values.
void note_defaults(const std::string& file, const support::Device& device);

}  // namespace tactree::cli
