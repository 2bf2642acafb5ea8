#include <algorithm>
#include <deque>
#include <exception>
#include <iterator>
#include <memory>
#include <string>

#include "tactree/client/board.hpp"
#include "tactree/client/tactree.h"

static_assert(TACTREE_USUAL_BAUD == tactree::client::kUsualBaud);

struct tactree_board {
  explicit tactree_board(const char* port, unsigned baud, unsigned link_timeout_ms)
      : board(port, {baud, static_cast<std::uint16_t>(std::min(link_timeout_ms, 0xFFFFU))}) {}
  tactree::client::Board board;
  std::deque<tactree::client::Telemetry> waiting;  // taken from the stream, not yet by the caller
  std::string error;
  bool failed_since_loss = false;  // `error` is of a call after the loss
  mutable std::string loss;
};

namespace {

using tactree::client::Board;
using tactree::client::Telemetry;
using tactree::core::wire::BoardFlag;

thread_local std::string error_of_open;  // NOLINT: C has no other place for it

/// Exceptions must not reach C code.
template <class Action>
int guarded(std::string& error, Action action) {
  try {
    action();
    return 0;
  } catch (const std::exception& problem) {
    error = problem.what();
    return -1;
  }
}

template <class Action>
int guarded(tactree_board& board, Action action) {
  const int result = guarded(board.error, [&] { action(board.board); });
  board.failed_since_loss = !board.board.loss().empty() && (result != 0 || board.failed_since_loss);
  return result;
}

void copy(const float (&from)[3], float (&to)[3]) {
  std::copy(std::begin(from), std::end(from), std::begin(to));
}

tactree_sample sample_of(const Telemetry& t) {
  tactree_sample s{};
  s.tick = t.header.tick;
  s.state = t.state;
  s.faults = t.faults;
  s.limits = t.limits;
  copy(t.probe_m, s.probe_m);
  copy(t.velocity_m_s, s.velocity_m_s);
  copy(t.force_N, s.force_N);
  copy(t.proxy_m, s.proxy_m);
  copy(t.normal, s.normal);
  s.penetration_m = t.penetration_m;
  s.body = t.body;
  return s;
}

}  // namespace

extern "C" {

tactree_board* tactree_open(const char* port, unsigned baud, unsigned link_timeout_ms) {
  std::unique_ptr<tactree_board> board;
  (void)guarded(error_of_open,
                [&] { board = std::make_unique<tactree_board>(port, baud, link_timeout_ms); });
  return board.release();
}

int tactree_reconnect(tactree_board* board) {
  return guarded(*board, [&](Board& it) {
    board->waiting.clear();
    it.reconnect();
  });
}

int tactree_connected(const tactree_board* board) { return board->board.connected() ? 1 : 0; }

void tactree_close(tactree_board* board) { delete board; }

const char* tactree_error(const tactree_board* board) {
  if (board == nullptr) {
    return error_of_open.c_str();
  }
  board->loss = board->board.loss();
  return board->loss.empty() || board->failed_since_loss ? board->error.c_str()
                                                         : board->loss.c_str();
}

int tactree_arm(tactree_board* board, unsigned patience_ms) {
  return guarded(*board, [&](Board& it) { it.arm(std::chrono::milliseconds(patience_ms)); });
}

int tactree_stop(tactree_board* board) {
  return guarded(*board, [](Board& it) { it.stop(); });
}

int tactree_clear_faults(tactree_board* board) {
  return guarded(*board, [](Board& it) { it.clear_faults(); });
}

int tactree_home(tactree_board* board) {
  return guarded(*board, [](Board& it) { it.home(); });
}

int tactree_subscribe(tactree_board* board, unsigned every_ticks) {
  return guarded(*board, [&](Board& it) { it.subscribe({0xFF, every_ticks}); });
}

int tactree_set_material(tactree_board* board, float stiffness_N_m, float damping_Ns_m,
                         float static_friction, float dynamic_friction) {
  return guarded(*board, [&](Board& it) {
    it.set_material({stiffness_N_m, damping_Ns_m, static_friction, dynamic_friction, 0});
  });
}

int tactree_set_texture(tactree_board* board, float height_m, float wavelength_m) {
  return guarded(*board, [&](Board& it) { it.set_texture({height_m, wavelength_m}); });
}

int tactree_capabilities(tactree_board* board, tactree_limits* limits) {
  return guarded(*board, [&](Board& it) {
    const tactree::core::wire::CapabilitiesReply can = it.capabilities();
    const auto has = [&](BoardFlag flag) { return has_flag(can, flag) ? 1 : 0; };
    *limits = {can.rate_hz,
               can.force_max_N,
               can.force_limit_N,
               can.host_force_max_N,
               can.stiffness_N_m,
               can.stiffness_limit_N_m,
               can.bodies,
               has(BoardFlag::kHomed),
               has(BoardFlag::kDeadManRequired),
               has(BoardFlag::kWatchOnly)};
  });
}

void tactree_sleep(const tactree_board* board, unsigned duration_ms) {
  board->board.connection().sleep(std::chrono::milliseconds(duration_ms));
}

void tactree_latest(const tactree_board* board, tactree_sample* sample) {
  *sample = sample_of(board->board.latest());
}

size_t tactree_take(tactree_board* board, tactree_sample* samples, size_t most) {
  const std::vector<Telemetry> news = board->board.take_stream();
  board->waiting.insert(board->waiting.end(), news.begin(), news.end());
  const std::size_t count = std::min(most, board->waiting.size());
  const auto end = board->waiting.begin() + static_cast<std::ptrdiff_t>(count);
  std::transform(board->waiting.begin(), end, samples, sample_of);
  board->waiting.erase(board->waiting.begin(), end);
  return count;
}

uint64_t tactree_dropped(const tactree_board* board) { return board->board.dropped(); }

void tactree_move_body(tactree_board* board, uint32_t body, const float rotation_wxyz[4],
                       const float translation_m[3], const float velocity_m_s[3]) {
  const float* const q = rotation_wxyz;
  const float* const t = translation_m;
  const float* const v = velocity_m_s;
  board->board.move_body(body, {{q[0], {q[1], q[2], q[3]}}, {t[0], t[1], t[2]}},
                         {{v[0], v[1], v[2]}, {}});
}

void tactree_add_force(tactree_board* board, const float force_N[3], unsigned duration_ms) {
  board->board.add_force({force_N[0], force_N[1], force_N[2]}, duration_ms);
}

int tactree_in_session(const tactree_board* board) { return board->board.in_session() ? 1 : 0; }
}
