#pragma once

#include <stdexcept>

namespace tactree::emulation {

/// An emulated session that cannot begin or go on. The text is "what: cause (remedy)".
class EmulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::emulation
