#pragma once
// A controller that runs in the firmware image of a board, in an emulator (QEMU), in lockstep with
// the simulation. Deterministic: equal inputs give equal outputs and instruction counts.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "tactree/client/transport.hpp"
#include "tactree/emulation/board_description.hpp"
#include "tactree/emulation/emulation_error.hpp"
#include "tactree/emulation/instruction_counts.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::emulation {

struct EmulationOptions {
  /// Image of the board. If empty, find_image() finds it.
  std::filesystem::path image;
  /// Number of ticks at the beginning that are not counted.
  std::uint64_t uncounted_ticks = 0;
  bool count_instructions = true;
  /// Also records the code and data that the ticks access. This halves the speed.
  bool note_code = false;
  /// Connects programs to the serial port of the board; nullptr if unused. Must outlive the target.
  client::Transport* served = nullptr;
  /// Overrides BoardDescription::instruction_shift.
  std::optional<std::uint32_t> instruction_shift;
  /// Time-outs in real time: until the board has started, and for each tick.
  std::chrono::milliseconds start_limit{120'000};
  std::chrono::milliseconds tick_limit{20'000};
};

/// Path of the image of a board. The image is searched in `folder` if that is not empty, else in
/// the folder that the environment variable TACTREE_FIRMWARE names, else in the installation and
/// the build tree. Throws EmulationError with the commands that build the image.
[[nodiscard]] std::filesystem::path find_image(const BoardDescription& board,
                                               const std::filesystem::path& folder = {});

class EmulatedTarget : public simulation::Target {
 public:
  /// Boots the board with `blob` at its flash address and waits for its hello message. Only the
  /// size of the blob is checked here; the board checks its content. All functions throw
  /// EmulationError if emulator, image or board fail.
  EmulatedTarget(const BoardDescription& board, std::span<const std::byte> blob,
                 const EmulationOptions& options);
  ~EmulatedTarget() override;

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  core::Status tick(hal::sim::SimBoard& board) override;
  /// Ends the emulator and reads the counts.
  void finish() override;

  /// nullopt before finish() and if instructions are not counted.
  [[nodiscard]] const std::optional<InstructionCounts>& instruction_counts() const;

 private:
  class Session;
  std::unique_ptr<Session> session_;
};

}  // namespace tactree::emulation
