#pragma once
// `tactree build --fit`.

#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::cli {

/// `text` is a length in metres, `device`, or `device:` and the name or file of a device. Throws
/// CLI::ValidationError, and UserError for a device that cannot be read.
void set_fit(const std::string& text, builder::BuildOptions& build);

}  // namespace tactree::cli
