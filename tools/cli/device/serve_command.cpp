#include <fmt/format.h>

#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "device/share_token.hpp"
#include "option_checks.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/share/server.hpp"
#include "tactree/share/shared_board.hpp"
#include "tactree/support/blob_file.hpp"

namespace tactree::cli {
namespace {

struct SharingOptions {
  std::string blob;
  BoardPort port;
  share::ServerSettings server{
      .server = {.address = "127.0.0.1", .port = 10001, .port_option = "--tcp-port"}, .tell = {}};
  std::string token_file;
  std::string grip = "neutral";
  int link_timeout_ms = 50;
  bool arm = false;
};

/// For several threads, therefore without exceptions and in one write.
void tell_terminal(const std::string& text) {
  (void)std::fputs((text + "\n").c_str(), stdout);
  (void)std::fflush(stdout);
}

std::optional<share::KnownModel> known_model(const std::string& blob) {
  if (blob.empty()) {
    return std::nullopt;
  }
  const support::BlobFile file(blob);
  const std::string name = text_of(file.view().header().name);
  return share::KnownModel{name.empty() ? blob : name, file.view().point_count(),
                           file.bytes().size(), core::crc32(file.bytes())};
}

void share_board(const SharingOptions& options) {
  share::BoardSettings settings;
  settings.model = known_model(options.blob);
  settings.port = chosen_port(options.port);
  settings.link.baud = options.port.baud;
  settings.link.link_timeout_ms = static_cast<std::uint16_t>(options.link_timeout_ms);
  settings.arm = options.arm;
  settings.tell = tell_terminal;
  share::ServerSettings serving = options.server;
  serving.grip = options.grip == "none" ? share::Grip::kNone : share::Grip::kNeutral;
  serving.tell = tell_terminal;
  serving.token = share_token(options.token_file, options.server.server.address);
  share::SharedBoard board(std::move(settings));
  share::Server server(serving, board);
  tell_terminal(
      fmt::format("board {} is shared at {} (Ctrl+C ends it)", board.name(), server.address()));
  tell_terminal(
      fmt::format("to watch: tactree monitor, record or view --port {}", server.watch_port()));
  const auto announcement = announce_port(
      server.watch_port(),
      fmt::format("board {}, shared by tactree serve: to watch and stop", board.name()));
  server.run();
}

}  // namespace

void add_serve_command(CLI::App& app, int&) {
  auto options = std::make_shared<SharingOptions>();
  CLI::App* verb = app.add_subcommand("serve",
                                      "Shares a board among several programs, by a WebSocket. One "
                                      "of them is in command, the others watch");
  verb->add_option("BLOB", options->blob,
                   "the model that the board uses, whose name the board does not report");
  add_port_options(*verb, options->port);
  verb->add_option("--tcp-port", options->server.server.port,
                   "TCP port of the WebSocket; 0: any free port")
      ->capture_default_str();
  verb->add_option("--address", options->server.server.address,
                   "address to listen on; with an address other than loopback, others on the "
                   "network who know the token can arm the board and send forces to it")
      ->capture_default_str();
  verb->add_option("--token-file", options->token_file,
                   "file with the token that programs must send (default: none on loopback; "
                   "elsewhere a new one, which is printed)");
  verb->add_option("--watch-socket", options->server.watch_socket,
                   "path of the socket at which tactree monitor, record and view watch the board "
                   "(default: a new one, which tactree devices lists)");
  verb->add_option("--grip", options->grip,
                   "neutral: messages contain a grip at rest, for programs that need one; none")
      ->check(one_of({"neutral", "none"}))
      ->capture_default_str();
  add_link_timeout_option(*verb, options->link_timeout_ms);
  verb->add_flag("--arm", options->arm,
                 "arm the board at the start, for programs that cannot (default: a program arms "
                 "it)");
  verb->callback([options] { share_board(*options); });
}

}  // namespace tactree::cli
