#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct ParamsOptions {
  BoardPort port;
  std::vector<std::string> settings;
  bool save = false;
  std::string json;
};

void set(client::Board& board, const std::string& setting) {
  const std::size_t equals = setting.find('=');
  float value = 0.0F;
  const char* const begin = setting.data() + (equals == std::string::npos ? 0 : equals + 1);
  const char* const end = setting.data() + setting.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (equals == std::string::npos || error != std::errc{} || rest != end) {
    throw support::UserError(fmt::format(
        "'{}' is not of the form NAME=NUMBER (tactree params lists the names)", setting));
  }
  board.set_parameter(setting.substr(0, equals), value);
}

void handle(const ParamsOptions& options) {
  const auto board = connect(options.port);
  for (const std::string& setting : options.settings) {
    set(*board, setting);
  }
  if (options.save) {
    board->save_parameters();
  }
  nlohmann::json all = nlohmann::json::object();
  for (const core::wire::ParameterReply& p : board->parameters()) {
    fmt::print("{:34} {:12g}   {:g} .. {:g}\n", text_of(p.name), p.value, p.min, p.max);
    all[text_of(p.name)] = {{"value", p.value}, {"min", p.min}, {"max", p.max}};
  }
  if (!options.json.empty()) {
    support::write_file(options.json, all.dump(2) + "\n");
  }
}

}  // namespace

void add_params_command(CLI::App& app, int&) {
  auto options = std::make_shared<ParamsOptions>();
  CLI::App* verb =
      app.add_subcommand("params", "Lists and sets a board's calibration: names, values, ranges");
  verb->add_option("SETTING", options->settings,
                   "NAME=NUMBER: a value to set until the board's next reset");
  verb->add_flag("--save", options->save, "save all values permanently in the board");
  add_port_options(*verb, options->port);
  verb->add_option("--json", options->json, "write the list to this file");
  verb->callback([options] { handle(*options); });
}

}  // namespace tactree::cli
