#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/named_output.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {
namespace {

struct DeviceOptions {
  std::string file;
  std::string output;
  std::string variable = "kDevice";
  std::string json;
};

nlohmann::ordered_json report_of(const std::string& file, const support::DeviceReading& reading) {
  nlohmann::ordered_json mistakes = nlohmann::ordered_json::array();
  for (const support::DeviceMistake& mistake : reading.mistakes) {
    mistakes.push_back({{"line", mistake.line},
                        {"column", mistake.column},
                        {"field", mistake.field},
                        {"cause", mistake.cause},
                        {"remedy", mistake.remedy}});
  }
  nlohmann::ordered_json defaults = nlohmann::ordered_json::array();
  for (const support::DeviceDefault& used : reading.device.defaults) {
    defaults.push_back(
        {{"field", used.field}, {"value", used.value}, {"consequence", used.consequence}});
  }
  return {{"file", file},
          {"valid", reading.mistakes.empty()},
          {"mistakes", mistakes},
          {"defaults", defaults}};
}

void print_defaults(const support::Device& device) {
  for (const support::DeviceDefault& used : device.defaults) {
    fmt::print("default   {} = {}: {}\n", used.field, used.value, used.consequence);
  }
}

support::DeviceReading reading_of(const std::string& name_or_file) {
  const std::vector<std::string> presets = support::device_names();
  return std::find(presets.begin(), presets.end(), name_or_file) != presets.end()
             ? support::DeviceReading{support::load_device(name_or_file), {}}
             : support::read_device(name_or_file);
}

void check(const DeviceOptions& options, int& exit_code) {
  support::check_outputs({options.json}, {options.file});
  const support::DeviceReading reading = reading_of(options.file);
  if (!options.json.empty()) {
    support::write_file(options.json, support::json_text(report_of(options.file, reading)));
  }
  for (const support::DeviceMistake& mistake : reading.mistakes) {
    fmt::print(stderr, "tactree: error: {}\n", support::mistake_text(options.file, mistake));
  }
  if (!reading.mistakes.empty()) {
    exit_code = kExitFailed;
    return;
  }
  const core::DeviceModel& model = reading.device.preset.model;
  fmt::print("{}: valid: {}, {} ax{}\n", options.file, reading.device.name,
             core::axes_of(model.kind), core::axes_of(model.kind) == 1 ? "is" : "es");
  print_defaults(reading.device);
}

void write_header(const DeviceOptions& options) {
  const support::NamedOutput output(options.output);
  support::check_outputs({output.file()}, {options.file});
  const support::Device device = support::load_device(options.file);
  const std::string header = support::device_header(
      device, options.variable, std::filesystem::path(options.file).filename().string());
  output.write(std::as_bytes(std::span(header)));
  fmt::print("wrote     {}: {} as {}\n", options.output, device.name, options.variable);
  print_defaults(device);
}

/// Empty if `name` can name a variable, else the error. The compiler refuses keywords.
std::string is_identifier(const std::string& name) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const bool good = !name.empty() && is_letter(name[0]) &&
                    std::all_of(name.begin(), name.end(),
                                [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
  return good ? "" : fmt::format("'{}' is not a C++ name (use letters, digits and _)", name);
}

}  // namespace

void add_device_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DeviceOptions>();
  CLI::App* verb = app.add_subcommand(
      "device", "Checks a device file, or converts it to a C++ header for firmware");
  verb->require_subcommand(1);
  verb->footer("`tactree simulate --device NAME --dump-device` prints a file to begin with.");

  CLI::App* check_verb = verb->add_subcommand(
      "check",
      "Names all mistakes of a device file, and the defaults in use; exit code 0 if it is valid");
  check_verb->add_option("FILE", options->file, "device file to check, or name of a device")
      ->required();
  check_verb->add_option("--json", options->json, "write the result as JSON to this file");
  check_verb->callback([options, &exit_code] { check(*options, exit_code); });

  CLI::App* header_verb = verb->add_subcommand(
      "to-header", "Writes a C++ header with the device as a core::DevicePreset for firmware");
  header_verb->add_option("FILE", options->file, "device file, or name of a device")->required();
  header_verb->add_option("-o,--output", options->output, "header to write; -: standard output")
      ->required();
  header_verb->add_option("--name", options->variable, "name of the variable")
      ->check(is_identifier)
      ->capture_default_str();
  header_verb->callback([options] { write_header(*options); });

  CLI::App* schema_verb =
      verb->add_subcommand("schema", "Prints the JSON schema of device files, for editors");
  schema_verb->callback([] { fmt::print("{}", support::device_schema()); });
}

}  // namespace tactree::cli
