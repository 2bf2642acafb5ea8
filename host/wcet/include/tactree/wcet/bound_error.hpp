#pragma once

#include <stdexcept>

namespace tactree::wcet {

/// The analysis cannot prove a bound, or cannot read its input. The text is "location: cause
/// (hint)".
class BoundError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::wcet
