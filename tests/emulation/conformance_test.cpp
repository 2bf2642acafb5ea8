// The conformance program passes on every board and fails on a defective one.

#include <functional>

#include "boards_for_test.hpp"

namespace tactree::test {
namespace {

constexpr int kTicksMax = 2000;

/// Boots the program and runs it to its end; returns its output.
std::string verdict(const emulation::BoardDescription& board,
                    const std::function<void(hal::sim::SimBoard&)>& prepare) {
  emulation::EmulationOptions options;
  options.image = built(board, "tests/on_target", std::string("conformance-") + board.name);
  options.count_instructions = false;
  hal::sim::SimBoard device({}, {});
  for (std::uint32_t i = 0; i <= hal::sim::kMaxLatencyTicks; ++i) {
    device.sample({0.01, 0.02, 0.03});
  }
  prepare(device);
  emulation::EmulatedTarget target(board, touched_shape().bytes(), options);
  (void)target.start(device, {});
  try {
    for (int i = 0; i < kTicksMax; ++i) {
      device.sample({0.01, 0.02, 0.03});
      (void)target.tick(device);
    }
  } catch (const emulation::EmulationError& end) {
    return end.what();
  }
  return "it did not end";
}

class Conformance : public OnBoard {};
TACTREE_ON_EVERY_BOARD(Conformance);

TEST_P(Conformance, PassesOnBoard) {
  const std::string found = verdict(board(), [](hal::sim::SimBoard&) {});
  EXPECT_NE(found.find("exit code 0"), std::string::npos) << found;
  EXPECT_NE(found.find("conformance passed"), std::string::npos) << found;
}

TEST_P(Conformance, FailsOnDefectiveBoard) {
  const std::string found = verdict(board(), [](hal::sim::SimBoard& b) {
    b.encoders().inject(1, hal::sim::EncoderFault::kDisconnected);
    b.safety_inputs().hold_dead_man(true);
    b.enable_line().stick(false);
  });
  EXPECT_NE(found.find("exit code 1"), std::string::npos) << found;
  EXPECT_NE(found.find("an encoder at rest is not valid"), std::string::npos) << found;
  EXPECT_NE(found.find("the dead-man control reads as held"), std::string::npos) << found;
  EXPECT_NE(found.find("the read-back does not follow when the enable line goes on"),
            std::string::npos)
      << found;
}

}  // namespace
}  // namespace tactree::test
