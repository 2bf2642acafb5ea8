#pragma once
// Cycles of a tick on a board, from the image of its firmware.

#include <string>
#include <vector>

#include "image/firmware_image.hpp"
#include "tactree/core/control/tick_cost.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/wcet/bound.hpp"

namespace tactree::cli {

struct BoardCosts {
  wcet::BoardTiming timing;
  core::TickCosts costs;
  std::string image;
  bool embedded = false;  ///< false: the image contains no costs, they result from an analysis

  /// Work tier of the board with this model alone, and the cycles of a tick at this tier. Both use
  /// mode, rate and kind of device of the configuration.
  [[nodiscard]] std::uint32_t work_tier(const core::BlobHeader& header,
                                        const core::Configuration& configuration) const;
  [[nodiscard]] double cycles(const core::BlobHeader& header,
                              const core::Configuration& configuration) const;
  /// Maximum rate, Hz, at which the board renders this model in time.
  [[nodiscard]] double highest_rate(const core::BlobHeader& header,
                                    const core::Configuration& configuration) const;

 private:
  [[nodiscard]] wcet::WorkTierCycles cycles_at_tiers(
      const core::BlobHeader& header, const core::Configuration& configuration) const;
};

/// Folder of the sources from which this program was built, the default for the analysis of an
/// image.
[[nodiscard]] std::string source_folder();

/// Options for the analysis of a board's image, without model and timing. `firmware` is the folder
/// of the image, see emulation::find_image().
[[nodiscard]] wcet::BoundOptions analysis_of(const emulation::BoardDescription& board,
                                             const std::string& firmware);

/// `firmware` as above. Throws UserError on an unknown board, wcet::BoundError and
/// EmulationError.
[[nodiscard]] BoardCosts costs_of_board(const std::string& name, const std::string& firmware = {});

/// The device of this name or file. If empty, a device of the kind that takes the maximum cycles.
[[nodiscard]] core::DeviceModel slowest_or(const std::string& device);

/// Costs of the image of a firmware: those stored in it at the clock that it states, or of a board
/// with a known timing. `board`: name or JSON file; if empty, the name in the image. Throws
/// UserError if neither is known, wcet::BoundError.
[[nodiscard]] BoardCosts costs_of_image(const std::string& file, const FirmwareImage& image,
                                        const std::string& board);

/// Boards with a known timing.
[[nodiscard]] std::vector<std::string> boards_with_timing();

}  // namespace tactree::cli
