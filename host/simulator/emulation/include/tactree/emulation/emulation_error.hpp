#pragma once

#include <stdexcept>

namespace tactree::emulation {

/// The emulated session cannot start or continue. The text is "location: cause (hint)".
class EmulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::emulation
