// Moves the object that a board's hand touches up and down, and draws the force as a line.
//   touch PORT [SECONDS]      PORT: a serial port, or what tactree simulate --serve prints

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <tactree/client/board.hpp>
#include <thread>

namespace {

void draw(const tactree::client::Telemetry& t) {
  const double force = std::hypot(t.force_N[0], t.force_N[1], t.force_N[2]);
  const auto length = static_cast<std::size_t>(std::min(60.0, 20.0 * force));
  std::printf("%8.3f N |%s\n", force, std::string(length, '=').c_str());
}

// Moves the object by the board's time: it does not jump if this program or the link is late.
void touch(tactree::client::Board& board, double seconds) {
  board.subscribe({.every_ticks = 20});
  board.arm();
  std::optional<std::uint32_t> begin_us;
  double t_s = 0.0;
  while (t_s < seconds && board.in_session()) {
    const tactree::client::Telemetry latest = board.latest();
    if (latest.header.tick != 0U) {  // 0: none has arrived
      begin_us = begin_us.value_or(latest.header.board_time_us);
      t_s = 1e-6 * (latest.header.board_time_us - *begin_us);
      tactree::core::Pose pose;  // 2 mm up and down, once in two seconds
      pose.translation_m.z = static_cast<float>(0.002 * std::sin(3.14159 * t_s));
      tactree::core::Motion motion;
      motion.linear_m_s.z = static_cast<float>(0.002 * 3.14159 * std::cos(3.14159 * t_s));
      board.move_body(0, pose, motion);
      draw(latest);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  board.stop();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: touch PORT [SECONDS]\n");
    return 2;
  }
  try {
    tactree::client::Board board(argv[1], {.link_timeout_ms = 100});
    touch(board, argc > 2 ? std::atof(argv[2]) : 10.0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "touch: %s\n", error.what());
    return 1;
  }
  return 0;
}
