// The C interface from the shared library, in C++: a port that does not exist is refused with its
// name.
#include <cstdio>
#include <string_view>

#include "tactree/client/tactree.h"

int main() {
  tactree_board* const board = tactree_open("unix:/nonexistent/socket", 0, 0);
  std::puts(tactree_error(nullptr));
  const std::string_view error = tactree_error(nullptr);
  return board == nullptr && error.find("/nonexistent/socket") != std::string_view::npos ? 0 : 1;
}
