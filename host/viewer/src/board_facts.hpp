#pragma once
// What a board tells about itself once for each connection, and whether its model is the one shown.

#include <cstddef>
#include <span>
#include <string>

#include "tactree/core/vec3.hpp"
#include "tactree/host/board.hpp"

namespace tactree::viewer {

struct BoardFacts {
  enum class Model { kSame, kOther, kUnknown };

  std::string name;
  std::string firmware;
  core::wire::CapabilitiesReply can{};
  core::Vec3 model_origin_m{};
  Model model = Model::kUnknown;
  std::string about_model;  ///< for people
};

/// Waits for the board's answers. `shown`: the bytes of the model that is drawn. Throws LinkError.
[[nodiscard]] BoardFacts ask_board(host::Board& board, std::span<const std::byte> shown);

}  // namespace tactree::viewer
