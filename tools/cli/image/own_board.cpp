#include "image/own_board.hpp"

#include <fmt/core.h>

#include <charconv>

#include "tactree/support/json_reader.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

wcet::BoardTiming read_timing(support::JsonReader reader, const std::string& board) {
  constexpr std::uint32_t kMaxWait = 1000;
  wcet::BoardTiming timing;
  timing.board = board;
  timing.clock_hz = reader.whole("clock_hz", 1'000'000, 2'000'000'000);
  timing.fetch_wait = reader.whole("fetch_wait", 0, kMaxWait);
  timing.line_bytes = reader.whole("line_bytes", 4, 4096);
  timing.cache_lines = reader.whole("cache_lines", 0, 1U << 20);
  timing.prefetches = reader.flag("prefetches");
  timing.ram_wait = reader.whole("ram_wait", 0, kMaxWait);
  timing.data_wait = reader.whole("data_wait", 0, kMaxWait);
  if (reader.has("ram_code_end")) {
    timing.ram_code_end = number_of(board + ": timing.ram_code_end", reader.text("ram_code_end"));
  }
  if ((timing.line_bytes & (timing.line_bytes - 1U)) != 0U) {
    reader.refuse("line_bytes", "is not a power of two", "give the bytes that one fetch reads");
  }
  timing.is_estimate = reader.flag("is_estimate");
  timing.source = reader.text("source");
  reader.finish();
  return timing;
}

}  // namespace

std::uint32_t number_of(const std::string& what, const std::string& text) {
  std::string digits = text;
  std::uint64_t factor = 1;
  if (text.ends_with('K') || text.ends_with('M')) {
    factor = text.ends_with('K') ? 1U << 10 : 1U << 20;
    digits.pop_back();
  }
  const bool is_hex = digits.starts_with("0x") || digits.starts_with("0X");
  const char* const begin = digits.data() + (is_hex ? 2 : 0);
  const char* const end = digits.data() + digits.size();
  std::uint64_t value = 0;
  const auto [behind, error] = std::from_chars(begin, end, value, is_hex ? 16 : 10);
  if (error != std::errc() || behind != end || value > UINT32_MAX || value * factor > UINT32_MAX) {
    throw support::UserError(fmt::format(
        "{}: '{}' is not a number below 2^32 (write 0x08020000, 917504, 896K or 1M)", what, text));
  }
  return static_cast<std::uint32_t>(value * factor);
}

bool is_board_file(const std::string& board) { return board.ends_with(".json"); }

OwnBoard read_board_file(const std::filesystem::path& file) {
  const support::JsonReader::Json json = support::read_json(file);
  support::JsonReader reader(file.string(), json, "docs/PORTING.md");
  if (reader.has("about")) {
    (void)reader.text("about");
  }
  OwnBoard board;
  board.name = reader.text("name");
  if (board.name.empty() || board.name.size() > 23) {
    reader.refuse("name", "has no or more than 23 characters", "choose a short name");
  }
  if (reader.has("timing")) {
    board.timing = read_timing(reader.object("timing"), board.name);
  }
  if (reader.has("blob")) {
    support::JsonReader blob = reader.object("blob");
    board.blob = {number_of(file.string() + ": blob.at", blob.text("at")),
                  number_of(file.string() + ": blob.room", blob.text("room"))};
    blob.finish();
  }
  if (reader.has("uf2_family")) {
    board.uf2_family = number_of(file.string() + ": uf2_family", reader.text("uf2_family"));
  }
  reader.finish();
  return board;
}

Unstated unstated_by(const std::string& board) {
  if (!is_board_file(board)) {
    return {};
  }
  const OwnBoard own = read_board_file(board);
  return {own.name, own.blob};
}

wcet::BoardTiming timing_of(const std::string& board) {
  if (is_board_file(board)) {
    const std::optional<wcet::BoardTiming> timing = read_board_file(board).timing;
    if (!timing) {
      throw support::UserError(
          fmt::format("{}: timing: is missing (docs/PORTING.md describes it)", board));
    }
    return *timing;
  }
  const wcet::BoardTiming* const timing = wcet::find_timing(board);
  if (timing == nullptr) {
    throw support::UserError(
        fmt::format("--board: the timing of {} is unknown (name another board, give the JSON file "
                    "of your board, or leave the option out)",
                    board));
  }
  return *timing;
}

}  // namespace tactree::cli
