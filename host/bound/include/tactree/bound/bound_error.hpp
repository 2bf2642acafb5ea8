#pragma once

#include <stdexcept>

namespace tactree::bound {

/// Something that has no bound, or cannot be read. The text is "where: cause (remedy)".
class BoundError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::bound
