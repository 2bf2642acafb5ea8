/* What a program in C does with a board. */
#include "tactree/client/tactree.h"

int c_program(const char* port);
int c_program(const char* port) {
  tactree_board* board = tactree_open(port, 115200, 0);
  if (board == NULL) {
    return 1;
  }
  int result =
      tactree_subscribe(board, 5) != 0 || tactree_set_material(board, 400, 1, 0.3f, 0.2f) != 0;
  if (result == 0 && tactree_arm(board, 20000) != 0) {
    result = 2;
  }
  tactree_sample sample;
  int left_ms = 20000;
  do {
    tactree_sleep(board, 1);
    tactree_latest(board, &sample);
    left_ms = left_ms - 1;
  } while (result == 0 && left_ms > 0 && tactree_in_session(board) && !(sample.force_N[2] > 0.05f));
  const float still[3] = {0, 0, 0};
  const float upright[4] = {1, 0, 0, 0};
  tactree_move_body(board, 0, upright, still, still);
  tactree_add_force(board, still, 20);
  tactree_sample taken[4];
  if (result == 0 && (left_ms == 0 || tactree_take(board, taken, 4) == 0)) {
    result = 3;
  }
  if (tactree_stop(board) != 0) {
    result = 4;
  }
  tactree_close(board);
  return result;
}
