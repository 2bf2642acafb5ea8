#pragma once
// Unit and worst case of the load that a board reports per tick.

#include <string>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/model/blob_format.hpp"
#include "tactree/viewer/frame.hpp"

namespace tactree::cli {

/// The load of a tick in cycles if the board reports its cycles per tick, in instructions for an
/// emulated board. The bound holds for this model on the board's image with any render mode and
/// device, because the board does not report them. `firmware` is the folder of the image, see
/// emulation::find_image(). Without a bound, `why` states the cause.
[[nodiscard]] viewer::Work work_of_board(const std::string& board,
                                         const core::wire::CapabilitiesReply& can,
                                         const core::BlobHeader& model,
                                         const std::string& firmware);

}  // namespace tactree::cli
