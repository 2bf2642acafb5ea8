// The C++ interface from the static library: a port that does not exist is refused with its name.
#include <cstdio>
#include <exception>
#include <string_view>

#include "tactree/client/board.hpp"

int main() {
  try {
    const tactree::client::Board board("unix:/nonexistent/socket");
  } catch (const std::exception& error) {
    std::puts(error.what());
    return std::string_view(error.what()).find("/nonexistent/socket") != std::string_view::npos ? 0
                                                                                                : 1;
  }
  return 1;
}
