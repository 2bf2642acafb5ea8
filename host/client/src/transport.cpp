#include "tactree/client/transport.hpp"

namespace tactree::client {

std::chrono::microseconds Transport::now() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace tactree::client
