#pragma once
// A simulated board as a USB device of this computer, in real time.

#include <optional>
#include <string>

#include "tactree/served/usb_board.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::cli {

struct UsbSimulationOptions {
  std::uint32_t serial = 1;       ///< last word of the serial number
  std::optional<double> seconds;  ///< none: until SIGINT or SIGTERM
};

[[nodiscard]] core::usb::Identity usb_identity(const UsbSimulationOptions& options);
[[nodiscard]] hal::BoardIdentity board_identity(const UsbSimulationOptions& options);

/// Plugs the board in and runs it. SIGUSR1 pulls its cable, or plugs it in again.
void run_on_usb(served::UsbBoard& board, simulation::Simulation& simulation,
                const core::Configuration& configuration, const UsbSimulationOptions& options);

}  // namespace tactree::cli
