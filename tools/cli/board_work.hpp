#pragma once
// How much a tick of a board has to do, from the share of its period that the board tells.

#include <string>

#include "tactree/core/blob_format.hpp"
#include "tactree/core/wire/messages.hpp"
#include "tactree/viewer/frame.hpp"

namespace tactree::cli {

/// In cycles where the board knows its clock; in instructions where it is an emulated one, whose
/// time is counted in them. The bound is that of this model on the board's image, whatever method
/// and kind of device the board has, which it does not tell. `firmware`: the folder of its image,
/// empty: where it was built or installed.
[[nodiscard]] viewer::Work work_of_board(const std::string& board,
                                         const core::wire::CapabilitiesReply& can,
                                         const core::BlobHeader& model,
                                         const std::string& firmware);

}  // namespace tactree::cli
