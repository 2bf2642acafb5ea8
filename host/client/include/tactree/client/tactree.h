/* C interface to a board with a haptic device. Requires a C99 compiler and the library
   tactree_client, which requires the C++ run-time library.

   An int function that can fail returns 0 on success and -1 on failure; tactree_error() returns the
   cause. A function marked "waits" waits for the board's reply; all others return immediately. A
   handle is for one thread at a time. */
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

/* Telemetry of one tick. Positions in m, in the frame of the scene. */
typedef struct {
  uint32_t tick;
  uint32_t state;  /* 0 boot, 1 no model, 2 idle, 3 armed, 4 active, 5 fault */
  uint32_t faults; /* bit n: the fault with code n, docs/faults/ */
  uint32_t limits;
  float probe_m[3];
  float velocity_m_s[3];
  float force_N[3]; /* after the safety gate */
  float proxy_m[3];
  float normal[3];
  float penetration_m;
  uint32_t body; /* in contact; 0xFFFFFFFF: none */
} tactree_sample;

/* What a board can do, and its present settings. */
typedef struct {
  float rate_hz;
  float force_max_N;         /* present setting */
  float force_limit_N;       /* largest setting */
  float added_force_max_N;   /* of tactree_add_force(): longer ones are scaled down */
  float stiffness_N_m;       /* present setting */
  float stiffness_limit_N_m; /* with the present damping; more is refused as unstable */
  uint32_t bodies;           /* bit n: there is a body n, which tactree_move_body() can move */
  int is_homed;              /* 0: tactree_home() is needed before tactree_arm() */
  int dead_man_required;     /* 1: the user must press a dead-man control to complete arming */
  int watch_only; /* 1: shared, or operated by its button; only watching and tactree_stop() */
} tactree_limits;

/* Opens a port and a session; waits. baud: speed of a serial port, usually TACTREE_USUAL_BAUD.
   link_timeout_ms: 5 to 100, the force ends if this program does not run for that long; 0: the
   force continues. Returns NULL on failure; tactree_error(NULL) then returns the message. */
tactree_board* tactree_open(const char* port, unsigned baud, unsigned link_timeout_ms);
/* Call after the connection was lost: opens the port and a new session, and renews the
   subscription. The board is not armed. Fails while the board is absent; waits. */
int tactree_reconnect(tactree_board* board);
/* Returns 0 once the connection is lost. */
int tactree_connected(const tactree_board* board);
/* Stops the board and closes the port; waits. NULL is allowed. */
void tactree_close(tactree_board* board);
/* Message of the last function that failed for this board. If the connection or the session was
   lost since then, the message states the loss instead, also if no function failed. With NULL:
   message of the last tactree_open() that failed in this thread. Valid until the next call with
   this board. */
const char* tactree_error(const tactree_board* board);

int tactree_arm(tactree_board* board, unsigned patience_ms); /* waits, also for the user */
int tactree_stop(tactree_board* board);                      /* waits */
int tactree_clear_faults(tactree_board* board);              /* waits */
int tactree_home(tactree_board* board);                      /* waits */
/* Subscribes to telemetry of one in every_ticks ticks; 0 ends the subscription; waits. */
int tactree_subscribe(tactree_board* board, unsigned every_ticks);
/* Reads limits and settings of the board; waits. */
int tactree_capabilities(tactree_board* board, tactree_limits* limits);
/* Sets stiffness, damping, static and dynamic friction; waits. */
int tactree_set_material(tactree_board* board, float stiffness_N_m, float damping_Ns_m,
                         float static_friction, float dynamic_friction);
/* Sets the bumps of the surface, cut into it; a height of 0 m: smooth. Where the model has
   materials that the board uses, theirs apply. A board of a protocol before 1.2 has none; waits. */
int tactree_set_texture(tactree_board* board, float height_m, float wavelength_m);

/* Waits until the time of the connection has advanced by duration_ms. Use it in polling loops: with
   a simulated board in lock-step, simulated time passes as fast as possible meanwhile. */
void tactree_sleep(const tactree_board* board, unsigned duration_ms);

/* Copies the newest sample; all zero before the first one. */
void tactree_latest(const tactree_board* board, tactree_sample* sample);
/* Takes up to `most` samples, oldest first, and returns their number. */
size_t tactree_take(tactree_board* board, tactree_sample* samples, size_t most);
/* Number of samples that were lost here or on the board because there was no room. */
uint64_t tactree_dropped(const tactree_board* board);
/* Moves a body. The rotation is a unit quaternion w, x, y, z. The body goes on with this velocity
   until the next call, also after the end of the session. */
void tactree_move_body(tactree_board* board, uint32_t body, const float rotation_wxyz[4],
                       const float translation_m[3], const float velocity_m_s[3]);
/* Adds a force for duration_ms, 1 to 100. The next force replaces it. */
void tactree_add_force(tactree_board* board, const float force_N[3], unsigned duration_ms);
/* Returns 0 if the board is gone, was reset, or another client opened a session. */
int tactree_in_session(const tactree_board* board);

#ifdef __cplusplus
}
#endif

#endif
