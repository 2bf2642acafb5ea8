#pragma once
// A controller in the firmware image of a board, in an emulator, in lockstep with the simulation.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "tactree/emulation/board_description.hpp"
#include "tactree/emulation/emulation_error.hpp"
#include "tactree/emulation/instruction_counts.hpp"
#include "tactree/host/transport.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::emulation {

struct EmulationOptions {
  /// Image of the board; empty: find_image().
  std::filesystem::path image;
  /// Ticks the instruction counter leaves out at the begin.
  std::uint64_t uncounted_ticks = 0;
  bool count_instructions = true;
  /// Also which code the ticks execute; about half as fast.
  bool note_code = false;
  /// Of programs that talk to the board at its serial port; nullptr: nobody does. Outlives the
  /// target.
  host::Transport* served = nullptr;
  /// In place of the board's own.
  std::optional<std::uint32_t> instruction_shift;
  /// Longest silence of a board, real time: while it starts, and between two ticks.
  std::chrono::milliseconds start_limit{120'000};
  std::chrono::milliseconds tick_limit{20'000};
};

/// Where the image of a board is: in `folder` when that is not empty, else in the folder that the
/// environment variable TACTREE_FIRMWARE names, the installation, or the build tree.
/// Throws EmulationError, telling how to build it.
[[nodiscard]] std::filesystem::path find_image(const BoardDescription& board,
                                               const std::filesystem::path& folder = {});

class EmulatedTarget : public simulation::Target {
 public:
  /// Boots the board with `blob` at its flash address and waits for its hello. The bytes are not
  /// checked but for their number: that is the board's work. Throws EmulationError, here and in all
  /// that follows, when emulator, image or board fail.
  EmulatedTarget(const BoardDescription& board, std::span<const std::byte> blob,
                 const EmulationOptions& options);
  ~EmulatedTarget() override;

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  core::Status tick(hal::sim::SimBoard& board) override;
  /// Ends the emulator and takes the counts.
  void finish() override;

  /// After finish(), where they were asked for.
  [[nodiscard]] const std::optional<InstructionCounts>& instruction_counts() const;

 private:
  class Session;
  std::unique_ptr<Session> session_;
};

}  // namespace tactree::emulation
