#pragma once
// Runs a Client over a Transport in a separate thread: requests from any thread, telemetry as the
// latest state and as a stream. post(), latest() and take_stream() never wait for the board, so
// they suit a render loop; call() waits for its reply.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tactree/client/client.hpp"
#include "tactree/client/transport.hpp"

namespace tactree::client {

struct ConnectionOptions {
  ClientOptions client{};
  /// Maximum number of telemetry messages that wait for take_stream(). Later ones are dropped and
  /// counted.
  std::size_t stream_capacity = 4096;
};

class Connection {
 public:
  explicit Connection(std::unique_ptr<Transport> transport, const ConnectionOptions& options = {});
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Opens a session and waits for it. Throws LinkError if the board does not reply, has another
  /// protocol version, or is busy.
  void open(std::uint16_t link_timeout_ms);

  /// Minor version of the protocol in this session: the smaller one of board and client.
  [[nodiscard]] std::uint8_t protocol_minor() const { return protocol_minor_; }

  /// Sends a request and waits for its response, at most for the client's timeout.
  [[nodiscard]] Response call(core::wire::MessageKind kind,
                              std::span<const std::byte> payload = {});
  template <core::wire::Message T>
  [[nodiscard]] Response call(core::wire::MessageKind kind, const T& message) {
    return call(kind, std::as_bytes(std::span(&message, 1)));
  }
  /// Sends several requests in order, with at most `window` of them pending. Stops after the first
  /// response that is not ok and returns it; otherwise returns the last response.
  struct Request {
    core::wire::MessageKind kind{};
    std::vector<std::byte> payload;
  };
  [[nodiscard]] Response call_all(std::span<const Request> requests, std::size_t window);

  /// Sends a request. Its reply is discarded; a refusal is counted in refusals().
  void post(core::wire::MessageKind kind, std::span<const std::byte> payload);
  template <core::wire::Message T>
  void post(core::wire::MessageKind kind, const T& message) {
    post(kind, std::as_bytes(std::span(&message, 1)));
  }
  /// Number of posted requests that were refused or got no reply.
  [[nodiscard]] std::uint64_t refusals() const;

  /// The newest telemetry; empty before the first.
  [[nodiscard]] std::optional<Telemetry> latest() const;
  /// All telemetry since the last call, oldest first.
  [[nodiscard]] std::vector<Telemetry> take_stream();
  /// Number of telemetry messages dropped here, and on the board since the last subscription.
  [[nodiscard]] std::uint64_t dropped() const;

  /// Time of the connection, Transport::now().
  [[nodiscard]] std::chrono::microseconds now() const;
  /// Waits until now() has advanced by `duration`, even if the board is lost meanwhile.
  void sleep(std::chrono::microseconds duration) const;
  /// Waits until take_stream() has a message, at most until now() has advanced by `duration`. In
  /// lock-step, time meanwhile passes not faster than real time.
  void wait_for_stream(std::chrono::microseconds duration) const;

  /// Returns false if the board was unplugged or the other side closed the connection.
  [[nodiscard]] bool connected() const;
  /// Also returns false if the board has ended the session, because it was reset or another client
  /// opened one.
  [[nodiscard]] bool in_session() const;
  [[nodiscard]] std::string name() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
  std::uint8_t protocol_minor_ = 0;
};

}  // namespace tactree::client
