#include "board_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "tactree/client/link_error.hpp"
#include "tactree/core/math/crc32.hpp"

namespace tactree::viewer {
namespace {

using core::wire::ModelSlot;

template <std::size_t N>
std::string text_of(const char (&field)[N]) {
  return {field, ::strnlen(field, N)};
}

void compare(const ModelSlot& in_use, std::span<const std::byte> shown, BoardFacts& facts) {
  if (in_use.bytes == shown.size() && in_use.checksum == core::crc32(shown)) {
    facts.model = BoardFacts::Model::kSame;
    facts.about_model = "The board uses the displayed model.";
    return;
  }
  facts.model = BoardFacts::Model::kOther;
  facts.about_model = fmt::format(
      "The board uses a model other than the displayed one ({} points, {} bytes; displayed: {} "
      "bytes). Display the board's model, or write this one with tactree flash.",
      in_use.points, in_use.bytes, shown.size());
}

void compare_models(client::Board& board, std::span<const std::byte> shown, BoardFacts& facts) {
  facts.about_model =
      "The board uses the model of its image and cannot identify it: make sure that it is the "
      "displayed one.";
  if (facts.can.slots == 0U) {
    return;
  }
  const core::wire::ListModelsReply list = board.models();
  const auto in_use = std::find_if(std::begin(list.slot), std::end(list.slot), [](auto& slot) {
    return slot.state == static_cast<std::uint8_t>(core::wire::SlotState::kActive);
  });
  if (in_use != std::end(list.slot)) {
    compare(*in_use, shown, facts);
  } else if (facts.can.bodies == 0U) {
    facts.model = BoardFacts::Model::kOther;
    facts.about_model = "The board has no model (tactree flash writes one).";
  }
}

}  // namespace

BoardFacts ask_board(client::Board& board, std::span<const std::byte> shown) {
  BoardFacts facts;
  const core::wire::IdentifyReply identity = board.identify();
  facts.name = text_of(identity.board);
  facts.firmware = text_of(identity.firmware);
  facts.can = board.capabilities();
  facts.model_origin_m = board.model_origin_m();
  compare_models(board, shown, facts);
  return facts;
}

}  // namespace tactree::viewer
