#include "tactree/host/transport.hpp"

namespace tactree::host {

std::chrono::microseconds Transport::now() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace tactree::host
