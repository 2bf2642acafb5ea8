#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "image/model_signature.hpp"
#include "option_checks.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct FlashOptions {
  BoardPort port;
  std::string blob;
  std::string json;
  bool list = false;
  bool roll_back = false;
  int erase = -1;
};

const char* word_for(std::uint8_t state) {
  constexpr const char* kWords[] = {"empty", "partial", "ready", "in use", "damaged"};
  return state < std::size(kWords) ? kWords[state] : "unknown";
}

/// A model that is older than one used before fails its validation, too, but is not damaged.
bool is_barred(const core::wire::ModelSlot& slot, std::uint32_t counter_min) {
  return slot.state == static_cast<std::uint8_t>(core::wire::SlotState::kDamaged) &&
         (slot.flags & 1U) != 0U && slot.counter < counter_min;
}

nlohmann::json to_json(const core::wire::ListModelsReply& models) {
  nlohmann::json slots = nlohmann::json::array();
  for (const core::wire::ModelSlot& slot : models.slot) {
    const bool barred = is_barred(slot, models.counter_min);
    slots.push_back({{"state", barred ? "barred by its counter" : word_for(slot.state)},
                     {"bytes", slot.bytes},
                     {"points", slot.points},
                     {"checksum", fmt::format("{:08x}", slot.checksum)},
                     {"signed", (slot.flags & 1U) != 0U},
                     {"counter", slot.counter}});
  }
  return {{"counter_min", models.counter_min}, {"slots", slots}};
}

void print_slots(const nlohmann::json& models) {
  int number = 0;
  for (const nlohmann::json& slot : models["slots"]) {
    fmt::print("slot {}: {}", number, slot["state"].get<std::string>());
    if (slot["bytes"].get<std::uint32_t>() != 0U) {
      fmt::print(", {} points, {} bytes, checksum {}{}", slot["points"].get<std::uint32_t>(),
                 slot["bytes"].get<std::uint32_t>(), slot["checksum"].get<std::string>(),
                 slot["signed"].get<bool>()
                     ? fmt::format(", signed, counter {}", slot["counter"].get<std::uint32_t>())
                     : "");
    }
    fmt::print("\n");
    ++number;
  }
}

void show_progress(std::size_t done, std::size_t all) {
  if (::isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r{:3.0f} %{}",
               100.0 * static_cast<double>(done) / static_cast<double>(all),
               done == all ? "\n" : "");
  }
}

void write_model(client::Board& board, const std::string& file) {
  const support::BlobFile blob(file);
  if (const auto warning = setup::size_warning(file, blob.view().header())) {
    fmt::print(stderr, "tactree: warning: {}\n", *warning);
  }
  client::ModelFile model;
  model.bytes = blob.bytes();
  if (const std::optional<ModelSignature> signature = read_signature(file)) {
    model.board = signature->board;
    model.counter = signature->counter;
    model.is_signed = true;
    model.signature = signature->signature;
  }
  board.flash(model, show_progress);
  fmt::print("{}: {} bytes written to the board and in use\n", file, blob.bytes().size());
}

void flash(const FlashOptions& options) {
  support::check_outputs({options.json}, {options.blob});
  const auto board = connect(options.port);
  if (!options.blob.empty()) {
    write_model(*board, options.blob);
  }
  if (options.roll_back) {
    board->roll_back();
  }
  if (options.erase >= 0) {
    board->erase_model(static_cast<std::uint32_t>(options.erase));
  }
  const nlohmann::json models = to_json(board->models());
  print_slots(models);
  if (!options.json.empty()) {
    support::write_file(options.json, models.dump(2) + "\n");
  }
}

}  // namespace

void add_flash_command(CLI::App& app, int&) {
  auto options = std::make_shared<FlashOptions>();
  CLI::App* verb = app.add_subcommand(
      "flash", "Writes a model, with its signature if there is one, to a board and activates it");
  CLI::Option* blob = verb->add_option("BLOB", options->blob, "the blob to write");
  CLI::Option* back =
      verb->add_flag("--roll-back", options->roll_back, "activate the previous model")
          ->excludes(blob);
  CLI::Option* erase =
      verb->add_option("--erase", options->erase, "erase this slot; it must not be in use")
          ->check(within(0, 1))
          ->excludes(blob)
          ->excludes(back);
  CLI::Option* list = verb->add_flag("--list", options->list, "only list the slots")
                          ->excludes(blob)
                          ->excludes(back)
                          ->excludes(erase);
  verb->callback([options, blob, back, erase, list] {
    if (blob->count() + back->count() + erase->count() + list->count() == 0U) {
      throw CLI::RequiredError("BLOB");
    }
    flash(*options);
  });
  add_port_options(*verb, options->port);
  verb->add_option("--json", options->json, "write the list of slots to this file");
}

}  // namespace tactree::cli
