/* The C interface from the shared library: a port that does not exist is refused with its name. */
#include <stdio.h>
#include <string.h>

#include "tactree/client/tactree.h"

int main(void) {
  tactree_board* board = tactree_open("unix:/nonexistent/socket", 0, 0);
  puts(tactree_error(NULL));
  return board == NULL && strstr(tactree_error(NULL), "/nonexistent/socket") != NULL ? 0 : 1;
}
