#pragma once
// Selects the board of a command: --port and --baud, or the only board found.

#include <CLI/CLI.hpp>
#include <cstring>
#include <memory>
#include <string>

#include "tactree/client/announcement.hpp"
#include "tactree/client/board.hpp"

namespace tactree::cli {

/// Forms of a port's name, for the help text.
inline constexpr const char* kPortForms =
    "a serial port, usb:SERIAL, unix:PATH (of tactree-controller or tactree serve), or the one "
    "that "
    "tactree simulate --serve prints (with --lock-step: step:PATH)";

struct BoardPort {
  std::string port;  ///< if empty, the only port found
  unsigned baud = client::kUsualBaud;
};

void add_port_options(CLI::App& verb, BoardPort& options);

/// Adds --link-timeout, the maximum time without a heartbeat, ms, for a board that this program
/// arms.
CLI::Option* add_link_timeout_option(CLI::App& verb, int& milliseconds);

/// Throws UserError if there is no board, or more than one.
[[nodiscard]] std::string chosen_port(const BoardPort& options);

/// Opens a session. Throws the exceptions of chosen_port() and client::Board.
[[nodiscard]] std::unique_ptr<client::Board> connect(const BoardPort& options);

/// Makes `tactree devices` list a port that this program serves, until the result is destroyed.
/// Warns and returns null if that is impossible: the port can be used nevertheless.
[[nodiscard]] std::unique_ptr<client::Announcement> announce_port(const std::string& port,
                                                                  const std::string& about);

/// Text of a field, which is zero-terminated unless the text fills the field.
template <std::size_t N>
[[nodiscard]] std::string text_of(const char (&field)[N]) {
  return {field, ::strnlen(field, N)};
}

}  // namespace tactree::cli
