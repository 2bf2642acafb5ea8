#include "usage_errors.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tactree/support/nearest_name.hpp"

namespace tactree {
namespace {

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = support::nearest_name(word, names);
  return nearest.empty() ? "" : "did you mean '" + nearest + "'? ";
}

/// The command that was parsed; the program itself if there was none.
const CLI::App& parsed_command(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
  }
  return *command;
}

/// "tactree device check", as it is typed.
std::string title(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : title(*command.get_parent()) + " " + command.get_name();
}

/// States which value is no number. CLI11 only says "Could not convert: --turn = x".
std::string not_a_number(const CLI::App& command, const std::string& message) {
  const std::size_t name = message.find(": ");
  const std::size_t value = message.find(" = ");
  if (name == std::string::npos || value == std::string::npos) {
    return message;
  }
  const std::string option = message.substr(name + 2, value - name - 2);
  const std::string text = message.substr(value + 3);
  if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos) {
    return fmt::format("{}: {} is too large", option, text);
  }
  const CLI::Option* const found = command.get_option_no_throw(option);
  const bool whole = found != nullptr && found->get_type_name().find("INT") != std::string::npos;
  return fmt::format("{}: '{}' is not {}", option, text, whole ? "a whole number" : "a number");
}

/// CLI11 says "--crop: 6 required FLOAT missing", or "At least 6 required but received 5".
std::string missing_values(const std::string& message) {
  const std::size_t name = message.find(": ");
  const std::size_t end = message.find(" required ");
  if (name == std::string::npos || end == std::string::npos || end < name) {
    return message;
  }
  const std::size_t begin = message.rfind(' ', end - 1) + 1;
  const std::string number = message.substr(begin, end - begin);
  return fmt::format("{}: {}", message.substr(0, name),
                     number == "1" ? "a value is required" : number + " values are required");
}

/// An argument that nothing takes; `remedy` begins with the option that was probably meant.
std::string unexpected(const CLI::App& command, const std::string& argument, std::string& remedy) {
  if (!argument.starts_with('-')) {
    return fmt::format("the argument '{}' is not expected", argument);
  }
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  const std::string option = argument.substr(0, argument.find('='));
  remedy = did_you_mean(option, names) + remedy;
  return fmt::format("there is no option '{}'", option);
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(verb->get_name());
  }
  return names;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> names = command_names(app);
  if (word.empty() || word[0] == '-' ||
      std::find(names.begin(), names.end(), word) != names.end()) {
    return "";
  }
  return fmt::format("unknown command '{}' ({}{} --help lists the commands)", word,
                     did_you_mean(word, names), app.get_name());
}

std::string usage_error(const CLI::App& app, const CLI::Error& error) {
  const CLI::App& command = parsed_command(app);
  const bool takes_commands = command.get_require_subcommand_min() > 0;
  std::string remedy = fmt::format("{} --help lists the {}", title(command),
                                   takes_commands ? "commands" : "options");
  const std::vector<std::string> extra = app.remaining(true);
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  std::string cause = error.what();
  if (code == CLI::ExitCodes::ConversionError) {
    cause = not_a_number(command, cause);
  } else if (code == CLI::ExitCodes::ArgumentMismatch) {
    cause = missing_values(cause);
  } else if (code == CLI::ExitCodes::ExtrasError && !extra.empty()) {
    cause = unexpected(command, extra.front(), remedy);
  } else if (code == CLI::ExitCodes::RequiredError && takes_commands) {
    cause = extra.empty() ? "a command is required"
                          : fmt::format("unknown command '{}'", extra.front());
    remedy = (extra.empty() ? "" : did_you_mean(extra.front(), command_names(command))) + remedy;
  }
  const bool has_remedy = cause.ends_with(')');
  return fmt::format("{}: error: {}{}\n", app.get_name(), cause,
                     has_remedy ? "" : " (" + remedy + ")");
}

}  // namespace tactree
