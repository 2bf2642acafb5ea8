#include "tactree/viewer/server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/thread_pool.hpp>
#include <csignal>
#include <optional>
#include <utility>

#include "http_connection.hpp"
#include "hub.hpp"

namespace tactree::viewer {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

tcp::endpoint endpoint_of(const ServerOptions& options) {
  boost::system::error_code error;
  const asio::ip::address address = asio::ip::make_address(options.address, error);
  if (error) {
    throw ServerError("--address: '" + options.address +
                      "' is not an IP address (give one such as 127.0.0.1 or ::1)");
  }
  return {address, options.port};
}

tcp::acceptor listen(asio::io_context& context, const ServerOptions& options) {
  const tcp::endpoint endpoint = endpoint_of(options);
  try {
    return tcp::acceptor(context, endpoint);
  } catch (const boost::system::system_error& error) {
    throw ServerError("cannot listen on " + options.address + " port " +
                      std::to_string(options.port) + ": " + error.code().message() +
                      " (choose another --page-port)");
  }
}

std::string host_of(const tcp::endpoint& endpoint) {
  const std::string address = endpoint.address().to_string();
  return (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" +
         std::to_string(endpoint.port());
}

}  // namespace

struct Server::Parts {
  Parts(const ServerOptions& options, const Site& site, Source& its_source)
      : context(std::make_unique<asio::io_context>(1)),
        acceptor(listen(*context, options)),
        hub(*context),
        source(its_source),
        service{site, its_source, hub, worker, host_of(acceptor->local_endpoint()), {}, {}},
        address("http://" + service.host + "/") {
    const tcp::endpoint own = acceptor->local_endpoint();
    if (own.address().is_loopback()) {
      service.local_host = "localhost:" + std::to_string(own.port());
    } else if (own.address().is_unspecified()) {
      service.any_host = ":" + std::to_string(own.port());
    }
  }
  // The context is destroyed first, because it destroys the open connections, which refer to hub
  // and service.
  ~Parts() {
    acceptor.reset();
    context.reset();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void accept() {
    acceptor->async_accept([this](boost::system::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) {
        return;
      }
      if (!error && service.connections < Service::kMaxConnections) {
        std::make_shared<HttpConnection>(std::move(socket), service)->read();
      }  // else the socket is closed
      accept();
    });
  }

  asio::thread_pool worker{1};
  std::unique_ptr<asio::io_context> context;
  std::optional<tcp::acceptor> acceptor;
  Hub hub;
  Source& source;
  Service service;
  std::string address;
};

Server::Server(const ServerOptions& options, const Site& site, Source& source)
    : parts_(std::make_unique<Parts>(options, site, source)) {}

Server::~Server() = default;

const std::string& Server::address() const { return parts_->address; }

std::uint16_t Server::port() const { return parts_->acceptor->local_endpoint().port(); }

void Server::run() {
  Parts& p = *parts_;
  asio::signal_set signals(*p.context, SIGINT, SIGTERM);
  signals.async_wait([this](boost::system::error_code error, int) {
    if (!error) {
      stop();
    }
  });
  p.source.start([&p](Message frame) { p.hub.offer(std::move(frame)); });
  p.accept();
  p.context->run();
  p.source.stop();
  p.worker.join();
}

void Server::stop() { parts_->context->stop(); }

}  // namespace tactree::viewer
