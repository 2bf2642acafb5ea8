#pragma once
// `tactree build --board` and `--for`: the finest model that a board, or the board of a firmware
// image, holds and renders in time.

#include <filesystem>
#include <span>
#include <string>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::cli {

struct BoardRequest {
  std::string board;     ///< name, or JSON file of a board; empty: any board
  std::string firmware;  ///< image that the model is for; empty: none
  std::string device;    ///< name or file; empty: the kind with the longest tick
  double rate_hz = 0.0;  ///< 0: any rate
  /// True if the board determines the size of the model, not the user.
  bool chooses_size = false;

  [[nodiscard]] bool is_any() const { return board.empty() && firmware.empty(); }
};

/// Sets the size of the board's flash, or the room of the image, as the budget unless the user has
/// chosen a size. Throws UserError if the image cannot be read, or the room is unknown.
void limit_to_board(BoardRequest& request, builder::BuildOptions& build);

/// Builds a model. If the board determines its size but is too slow for it, builds the finest model
/// that the board renders at the rate, and adds a note. Throws UserError if the board is too slow
/// for any model, and the exceptions of builder::build_model().
[[nodiscard]] builder::BuildResult build_for_board(std::span<const std::filesystem::path> inputs,
                                                   const builder::BuildOptions& build,
                                                   const BoardRequest& request,
                                                   builder::Progress& progress);

/// The blob of a result. Throws UserError if it is not valid.
[[nodiscard]] core::BlobView view_of(const builder::BuildResult& result);

}  // namespace tactree::cli
