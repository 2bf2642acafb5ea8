#include "tactree/web/listener.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/thread_pool.hpp>
#include <csignal>
#include <optional>
#include <utility>

#include "http_connection.hpp"

namespace tactree::web {
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
                      " (choose another " + options.port_option + ")");
  }
}

std::string host_of(const tcp::endpoint& endpoint) {
  const std::string address = endpoint.address().to_string();
  return (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" +
         std::to_string(endpoint.port());
}

}  // namespace

struct Listener::Parts {
  Parts(const ServerOptions& options, Content& content)
      : context(std::make_unique<asio::io_context>(1)),
        signals(std::in_place, *context, SIGINT, SIGTERM),
        acceptor(listen(*context, options)),
        service{content, worker, host_of(acceptor->local_endpoint()), {}, {}} {
    const tcp::endpoint own = acceptor->local_endpoint();
    if (own.address().is_loopback()) {
      service.local_host = "localhost:" + std::to_string(own.port());
    } else if (own.address().is_unspecified()) {
      service.any_host = ":" + std::to_string(own.port());
    }
  }
  ~Parts() { close(); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  // The context destroys the open connections, which refer to the service.
  void close() {
    acceptor.reset();
    signals.reset();
    context.reset();
  }

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
  std::optional<asio::signal_set> signals;  // caught before a program can find the port
  std::optional<tcp::acceptor> acceptor;
  Service service;
};

Listener::Listener(const ServerOptions& options, Content& content)
    : parts_(std::make_unique<Parts>(options, content)) {}

Listener::~Listener() = default;

const std::string& Listener::host() const { return parts_->service.host; }

std::uint16_t Listener::port() const { return parts_->acceptor->local_endpoint().port(); }

asio::io_context& Listener::context() { return *parts_->context; }

void Listener::run() {
  Parts& p = *parts_;
  p.signals->async_wait([this](boost::system::error_code error, int) {
    if (!error) {
      stop();
    }
  });
  p.accept();
  p.context->run();
  p.worker.join();
}

void Listener::stop() { parts_->context->stop(); }

void Listener::close() { parts_->close(); }

}  // namespace tactree::web
