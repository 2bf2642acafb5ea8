#pragma once
// A page's WebSocket: frames out, commands in.

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <memory>
#include <string>

#include "hub.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

class LiveConnection : public std::enable_shared_from_this<LiveConnection> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  /// Maximum size of a command, bytes, and number of unread answers beyond which the connection is
  /// closed.
  static constexpr std::size_t kMaxCommandBytes = 4096;
  static constexpr std::size_t kMaxAnswers = 16;

  LiveConnection(boost::beast::tcp_stream stream, Hub& hub, Source& source);
  ~LiveConnection();
  LiveConnection(const LiveConnection&) = delete;
  LiveConnection& operator=(const LiveConnection&) = delete;

  /// Accepts a request for a WebSocket. The object then keeps itself alive until the page leaves.
  void accept(const Request& request);
  /// Sends the frame as soon as possible; drops a frame that is still waiting.
  void show(const Message& frame);
  void close();

 private:
  void read();
  void execute(const std::string& text);
  void answer(std::string text);
  void write_next();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Hub& hub_;
  Source& source_;
  boost::beast::flat_buffer incoming_;
  std::deque<Message> answers_;  // sent before frames
  Message frame_;                // waiting
  Message writing_;              // being sent
  bool open_ = false;
};

}  // namespace tactree::viewer
