#include "tactree/viewer/server.hpp"

#include <utility>

#include "hub.hpp"
#include "live_connection.hpp"
#include "tactree/web/listener.hpp"

namespace tactree::viewer {

struct Server::Parts final : web::Content {
  Parts(const ServerOptions& options, const Site& its_site, Source& its_source)
      : listener(options, *this),
        hub(listener.context()),
        site(its_site),
        source(its_source),
        address("http://" + listener.host() + "/") {}
  // The open connections refer to the hub.
  ~Parts() override { listener.close(); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  [[nodiscard]] HttpResponse answer(std::string_view path) const override {
    if (path == "/status.json") {
      return {200, "application/json", hub.status_json(), {}};
    }
    return site.answer(path);
  }
  [[nodiscard]] bool is_slow(std::string_view path) const override { return Site::is_slow(path); }
  [[nodiscard]] bool is_socket(std::string_view path) const override { return path == "/live"; }
  [[nodiscard]] bool admits_programs() const override { return false; }
  void open_socket(boost::beast::tcp_stream stream, const web::Request& request) override {
    std::make_shared<LiveConnection>(std::move(stream), hub, source)->accept(request);
  }

  web::Listener listener;
  Hub hub;
  const Site& site;
  Source& source;
  std::string address;
};

Server::Server(const ServerOptions& options, const Site& site, Source& source)
    : parts_(std::make_unique<Parts>(options, site, source)) {}

Server::~Server() = default;

const std::string& Server::address() const { return parts_->address; }

std::uint16_t Server::port() const { return parts_->listener.port(); }

void Server::run() {
  Parts& p = *parts_;
  p.source.start([&p](Message frame) { p.hub.offer(std::move(frame)); });
  p.listener.run();
  p.source.stop();
}

void Server::stop() { parts_->listener.stop(); }

}  // namespace tactree::viewer
