/* Tactree for C: a board with a haptic device, for an application. Needs a C99 compiler; links
   tactree_client, which needs the C++ run-time library.

   A function that can fail returns 0 for success; tactree_error() then returns the cause. What is
   marked "waits" waits for the board's answer; the rest returns at once. A handle is for one thread
   at a time. */
#ifndef TACTREE_HOST_TACTREE_H
#define TACTREE_HOST_TACTREE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Speed of a serial port to a board, baud. */
#define TACTREE_USUAL_BAUD 1000000U

typedef struct tactree_board tactree_board;

/* One tick's telemetry. Positions in m, the scene's frame. */
typedef struct {
  uint32_t tick;
  uint32_t state;  /* 0 boot, 1 no model, 2 idle, 3 armed, 4 active, 5 fault */
  uint32_t faults; /* bit n: the fault with code n, docs/faults/ */
  uint32_t limits;
  float probe_m[3];
  float velocity_m_s[3];
  float force_N[3]; /* that the hand feels */
  float proxy_m[3];
  float normal[3];
  float penetration_m;
  uint32_t body; /* in contact; 0xFFFFFFFF: none */
} tactree_sample;

/* Opens a port and a session; waits. baud: of a serial port, by default TACTREE_USUAL_BAUD.
   link_timeout_ms: 5 to 100, the force ends if this program does not run for that long; 0: the
   force continues. Returns NULL on failure; the message is tactree_error(NULL). */
tactree_board* tactree_open(const char* port, unsigned baud, unsigned link_timeout_ms);
/* After the cable was pulled: reopens the port, a session and the subscription; nothing is
   armed. Fails while the board is not there; waits. */
int tactree_reconnect(tactree_board* board);
/* Not 0: the board is there. */
int tactree_connected(const tactree_board* board);
/* Stops the board and closes the port; waits. NULL is allowed. */
void tactree_close(tactree_board* board);
/* Message of the last function that failed for this board; NULL: of tactree_open() in this thread.
 */
const char* tactree_error(const tactree_board* board);

int tactree_arm(tactree_board* board, unsigned patience_ms); /* waits, also for the hand */
int tactree_stop(tactree_board* board);                      /* waits */
int tactree_clear_faults(tactree_board* board);              /* waits */
int tactree_home(tactree_board* board);                      /* waits */
/* Telemetry of every so many ticks; 0: none; waits. */
int tactree_subscribe(tactree_board* board, unsigned every_ticks);
/* Stiffness, damping, static and dynamic friction; waits. */
int tactree_set_material(tactree_board* board, float stiffness_N_m, float damping_Ns_m,
                         float static_friction, float dynamic_friction);

/* Waits for so much time of the connection. For loops that look for something: with a simulated
 * board in lock-step, time passes as fast as it can meanwhile. */
void tactree_sleep(const tactree_board* board, unsigned duration_ms);

/* The newest sample; all zero before the first. */
void tactree_latest(const tactree_board* board, tactree_sample* sample);
/* Takes up to `most` samples, oldest first, and returns how many; 0: there are none. */
size_t tactree_take(tactree_board* board, tactree_sample* samples, size_t most);
/* Samples that were lost because nobody took them, or the board had no room. */
uint64_t tactree_dropped(const tactree_board* board);
/* Rotation as a unit quaternion w, x, y, z. */
void tactree_move_body(tactree_board* board, uint32_t body, const float rotation_wxyz[4],
                       const float translation_m[3], const float velocity_m_s[3]);
/* Gone after duration_ms, 1 to 100, unless given again. */
void tactree_add_force(tactree_board* board, const float force_N[3], unsigned duration_ms);
/* 0: the board is gone, was reset, or somebody else opened a session. */
int tactree_in_session(const tactree_board* board);

#ifdef __cplusplus
}
#endif

#endif
