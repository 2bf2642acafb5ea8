#pragma once
// Copies bytes between the serial port of an emulated board and the programs connected to it.

#include <cstddef>
#include <vector>

#include "tactree/client/transport.hpp"
#include "tactree/support/high_descriptor.hpp"

namespace tactree::emulation {

class SerialBridge {
 public:
  /// `programs` must outlive the bridge. Throws EmulationError.
  explicit SerialBridge(client::Transport& programs);
  /// The descriptor that the emulator uses as its serial port.
  [[nodiscard]] int board_end() const { return board_.get(); }
  /// Copies the available bytes in both directions. Never blocks.
  void move();

 private:
  void flush();

  client::Transport& programs_;
  support::HighDescriptor ours_;
  support::HighDescriptor board_;
  // Bytes that could not be written yet.
  std::vector<std::byte> to_board_;
  std::vector<std::byte> to_programs_;
};

}  // namespace tactree::emulation
