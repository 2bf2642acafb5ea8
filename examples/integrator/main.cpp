// Firmware of the imaginary HC-3.

#include "hc3_board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/runtime/admission.hpp"
#include "tactree/runtime/self_test.hpp"

namespace {

constexpr std::uint32_t kClockHz = 168'000'000;

}  // namespace

extern "C" const tactree::runtime::ImageRecord tactree_image =
    tactree::runtime::image_record("hc3", {.clock_hz = kClockHz,
                                           .blob_at = hc3::kBlobAddress,
                                           .blob_room = hc3::kBlobRoom,
                                           .uf2_family = 0x57755A57});

int main() {
  static hc3::Board board;
  static tactree::core::Controller controller;
  static tactree::hal::Loop<hc3::Board> loop(board, controller);

  tactree::core::Configuration configuration;
  use_device(tactree::core::presets::premium(), configuration);
  configuration.link.required = true;
  // After a refusal the loop runs as well: it keeps the motors off, and the status has the cause.
  if (tactree::runtime::test_program() == tactree::hal::ImageStatus::kOk) {
    controller.know_costs(tactree::runtime::tick_costs(), kClockHz);
    (void)loop.start(configuration);
  }
  while (true) {
    (void)loop.tick();
  }
}
