#pragma once
#include <stdexcept>

namespace tactree::client {

/// A port or board that does not do what was asked. The text is "where: what (remedy)".
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::client
