// `tactree completion`: what the other commands and their options are called, for a shell.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "commands.hpp"
#include "option_checks.hpp"
#include "usage_errors.hpp"

namespace tactree::cli {
namespace {

// The names that an option may have as its value, as the help shows them: TEXT:a|b. CLI11 keeps
// them as a check only. Capitals stand for what the user chooses.
std::string choices(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::string list = type.substr(type.rfind(':') + 1);  // all of it without a colon
  if (list.find('|') == std::string::npos) {
    return "";
  }
  std::string names;
  std::string name;
  for (const char character : list + "|") {
    if (character != '|') {
      name += character;
      continue;
    }
    const bool is_name = !name.empty() && std::none_of(name.begin(), name.end(), [](char c) {
      return std::isupper(static_cast<unsigned char>(c)) != 0 || c == ' ' || c == '\'';
    });
    names += is_name ? (names.empty() ? "" : " ") + name : "";
    name.clear();
  }
  return names;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) {
    names.push_back("--" + name);
  }
  for (const std::string& name : option.get_snames()) {
    names.push_back("-" + name);
  }
  return names;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::string option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options_of(app)) {
    for (const std::string& name : names_of(*option)) {
      names.push_back(name);
    }
  }
  return fmt::format("{}", fmt::join(names, " "));
}

// One pattern of the `case` for each command: its own commands, its options, and what has a value.
void add_patterns(const CLI::App& app, const std::string& path, std::string& commands,
                  std::string& options, std::string& values) {
  commands += fmt::format("    '{}') echo '{}' ;;\n", path, fmt::join(command_names(app), " "));
  options += fmt::format("    '{}') echo '{}' ;;\n", path, option_names(app));
  for (const CLI::Option* option : options_of(app)) {
    if (option->get_items_expected_max() == 0) {
      continue;  // a flag
    }
    for (const std::string& name : names_of(*option)) {
      values += fmt::format("    '{} {}') echo '{}' ;;\n", path, name, choices(*option));
    }
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    add_patterns(*command, path + " " + command->get_name(), commands, options, values);
  }
}

// Each function of the script prints the words that fit, and fails where there are none of its
// kind.
constexpr const char* kScript = R"(# bash completion of tactree, written by: tactree completion bash
_tactree_commands() {{
  case "$1" in
{0}    *) return 1 ;;
  esac
}}

_tactree_options() {{
  case "$1" in
{1}    *) return 1 ;;
  esac
}}

_tactree_values() {{
  case "$1 $2" in
{2}    *) return 1 ;;
  esac
}}

_tactree() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} path=tactree i words=
  # Bash splits --option=value at the sign.
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    _tactree_options "$path ${{COMP_WORDS[i]}}" >/dev/null && path="$path ${{COMP_WORDS[i]}}"
  done
  COMPREPLY=()
  if ! words=$(_tactree_values "$path" "$before"); then
    case "$word" in
      -*) words=$(_tactree_options "$path") ;;
      *) words=$(_tactree_commands "$path") ;;
    esac
  fi
  # Without a word that fits, bash completes names of files.
  [ -z "$words" ] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}

complete -o default -F _tactree tactree
)";

void print_bash_completion(const CLI::App& app) {
  std::string commands;
  std::string options;
  std::string values;
  add_patterns(app, "tactree", commands, options, values);
  fmt::print(fmt::runtime(kScript), commands, options, values);
}

}  // namespace

void add_completion_command(CLI::App& app, int&) {
  CLI::App* verb = app.add_subcommand(
      "completion", "Prints a script by which a shell completes commands and options");
  verb->add_option("shell", "the shell")->required()->check(one_of({"bash"}));
  verb->footer(
      "For this shell: source <(tactree completion bash). For all: write it to\n"
      "/usr/share/bash-completion/completions/tactree.");
  verb->callback([&app] { print_bash_completion(app); });
}

}  // namespace tactree::cli
