#pragma once
// Properties of a board, which are read once per connection, and a comparison of its model with the
// displayed model.

#include <cstddef>
#include <span>
#include <string>

#include "tactree/client/board.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::viewer {

struct BoardFacts {
  enum class Model { kSame, kOther, kUnknown };

  std::string name;
  std::string firmware;
  core::wire::CapabilitiesReply can{};
  core::Vec3 model_origin_m{};
  Model model = Model::kUnknown;
  std::string about_model;  ///< text for the user
};

/// Blocks until the board has answered. `shown` contains the bytes of the displayed model. Throws
/// LinkError.
[[nodiscard]] BoardFacts ask_board(client::Board& board, std::span<const std::byte> shown);

}  // namespace tactree::viewer
