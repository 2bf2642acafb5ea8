#include "tactree/share/server.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "client_socket.hpp"
#include "tactree/web/listener.hpp"
#include "watch_port.hpp"

namespace tactree::share {
namespace {

namespace asio = boost::asio;

// Snapshots that wait for the server's thread: more than any client may wait for.
constexpr std::size_t kMaxSnapshots = kMaxQueue;

/// Takes the same time wherever two texts of the same length differ.
bool is_equal(std::string_view a, std::string_view b) {
  unsigned differences = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    differences |= static_cast<unsigned>(a[i] != b[i]);
  }
  return differences == 0U;
}

std::string_view text_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

bool has_token(const web::Request& request, const std::string& token) {
  constexpr std::string_view kBearer = "Bearer ";
  constexpr std::string_view kQuery = "token=";
  const std::string_view header = text_of(request[boost::beast::http::field::authorization]);
  if (header.starts_with(kBearer) && is_equal(header.substr(kBearer.size()), token)) {
    return true;
  }
  std::string_view target = text_of(request.target());
  for (std::size_t at = target.find('?'); at != std::string_view::npos; at = target.find('&')) {
    target.remove_prefix(at + 1U);
    if (target.starts_with(kQuery) &&
        is_equal(target.substr(0, target.find('&')).substr(kQuery.size()), token)) {
      return true;
    }
  }
  return false;
}

}  // namespace

struct Server::Parts final : web::Content {
  Parts(const ServerSettings& settings, SharedBoard& its_board)
      : board(its_board),
        token(settings.token),
        room{Clients(its_board, settings.grip), settings.tell},
        listener(settings.server, *this),
        watch_port(listener.context(), its_board, settings.watch_socket, settings.tell) {
    timer.emplace(listener.context());
  }
  // The open connections refer to the room and to the port.
  ~Parts() override {
    timer.reset();
    watch_port.close();
    listener.close();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  [[nodiscard]] web::HttpResponse answer(std::string_view) const override {
    return {404, "text/plain; charset=utf-8", "this server has only a WebSocket, at /\n", {}};
  }
  [[nodiscard]] bool is_slow(std::string_view) const override { return false; }
  [[nodiscard]] bool is_socket(std::string_view path) const override { return path == "/"; }
  [[nodiscard]] bool admits_programs() const override { return true; }
  [[nodiscard]] bool permits(const web::Request& request) const override {
    return token.empty() || has_token(request, token);
  }
  void open_socket(boost::beast::tcp_stream stream, const web::Request& request) override {
    std::make_shared<ClientSocket>(std::move(stream), room)->accept(request);
  }

  /// Called from the board's thread.
  void give(const std::vector<Snapshot>& snapshots) {
    const std::lock_guard lock(mutex);
    const bool idle = waiting.empty();
    waiting.insert(waiting.end(), snapshots.begin(), snapshots.end());
    if (waiting.size() > kMaxSnapshots) {
      waiting.erase(waiting.begin(), waiting.end() - static_cast<std::ptrdiff_t>(kMaxSnapshots));
    }
    if (idle) {
      asio::post(listener.context(), [this] { take(); });
    }
  }

  void take() {
    std::vector<Snapshot> snapshots;
    {
      const std::lock_guard lock(mutex);
      snapshots.swap(waiting);
    }
    for (const Snapshot& snapshot : snapshots) {
      room.clients.offer(snapshot);
      watch_port.offer(snapshot);
    }
    watch_port.write();
    for (ClientSocket* const socket : room.sockets) {
      socket->write_next();  // sends later
    }
  }

  void watch_clients() {
    timer->expires_after(ClientSocket::kCheckInterval);
    timer->async_wait([this](boost::system::error_code error) {
      if (error) {
        return;
      }
      const std::vector<ClientSocket*> sockets(room.sockets.begin(), room.sockets.end());
      for (ClientSocket* const socket : sockets) {
        socket->check(ClientSocket::Clock::now());  // its handlers keep it alive
      }
      watch_clients();
    });
  }

  SharedBoard& board;
  std::string token;
  Room room;
  web::Listener listener;
  WatchPort watch_port;
  std::optional<asio::steady_timer> timer;
  std::mutex mutex;  // guards waiting
  std::vector<Snapshot> waiting;
};

Server::Server(const ServerSettings& settings, SharedBoard& board)
    : parts_(std::make_unique<Parts>(settings, board)) {}

Server::~Server() = default;

std::string Server::address() const {
  return "ws://" + parts_->listener.host() + "/" +
         (parts_->token.empty() ? "" : "?token=" + parts_->token);
}

std::string Server::watch_port() const { return parts_->watch_port.port(); }

void Server::run() {
  Parts& p = *parts_;
  p.watch_clients();
  p.board.start([&p](const std::vector<Snapshot>& snapshots) { p.give(snapshots); });
  p.listener.run();
  p.board.end();
}

}  // namespace tactree::share
