#pragma once
// Errors that become exceptions of the package.

#include <stdexcept>

namespace tactree::python {

/// A file is refused: tactree.FileError.
class FileFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::python
