#pragma once
// Waits for the response to a request, in real or simulated time.

#include <cstdint>

#include "tactree/client/client.hpp"

namespace tactree::test {

/// Drops all other responses. Calls `advance()` to let time pass while `has_time()`; then times
/// out.
template <class HasTime, class Advance>
client::Response await_response(client::Client& client, std::uint16_t sequence, HasTime has_time,
                                Advance advance) {
  client::Response response;
  while (has_time()) {
    while (client.take(response)) {
      if (response.sequence == sequence) {
        return response;
      }
    }
    advance();
  }
  response = {};
  response.timed_out = true;
  return response;
}

}  // namespace tactree::test
