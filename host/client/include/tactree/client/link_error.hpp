#pragma once
#include <stdexcept>

namespace tactree::client {

/// Error of a port or board. Message: "where: what (hint)".
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace tactree::client
