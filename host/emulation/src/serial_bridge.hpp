#pragma once
// Bytes between the serial port of an emulated board and the programs that talk to it.

#include <cstddef>
#include <vector>

#include "file_descriptor.hpp"
#include "tactree/host/transport.hpp"

namespace tactree::emulation {

class SerialBridge {
 public:
  /// `programs` outlives the bridge.
  explicit SerialBridge(host::Transport& programs);
  /// For the emulator: what it reads there the programs wrote.
  [[nodiscard]] int board_end() const { return board_.get(); }
  /// Moves what there is, both ways. Never waits.
  void move();

 private:
  void flush();

  host::Transport& programs_;
  FileDescriptor ours_;
  FileDescriptor board_;
  std::vector<std::byte> to_board_;     // that had no room yet
  std::vector<std::byte> to_programs_;  // likewise
};

}  // namespace tactree::emulation
