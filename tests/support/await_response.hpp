#pragma once
// Waits for the answer to a request, in whatever time the test has.

#include <cstdint>

#include "tactree/host/client.hpp"

namespace tactree::test {

/// Everything else that comes is dropped. `go_on()` lets time go by, as long as `has_time()`.
template <class HasTime, class GoOn>
host::Response await_response(host::Client& client, std::uint16_t sequence, HasTime has_time,
                              GoOn go_on) {
  host::Response response;
  while (has_time()) {
    while (client.take(response)) {
      if (response.sequence == sequence) {
        return response;
      }
    }
    go_on();
  }
  response = {};
  response.timed_out = true;
  return response;
}

}  // namespace tactree::test
