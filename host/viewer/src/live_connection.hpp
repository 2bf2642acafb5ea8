#pragma once
// A page's WebSocket: frames out, commands in.

#include <boost/beast/core/tcp_stream.hpp>
#include <deque>
#include <memory>
#include <string>

#include "hub.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/web/web_socket.hpp"

namespace tactree::viewer {

class LiveConnection : public std::enable_shared_from_this<LiveConnection> {
 public:
  /// Maximum size of a command, bytes, and number of unread answers beyond which the connection is
  /// closed.
  static constexpr std::size_t kMaxCommandBytes = 4096;
  static constexpr std::size_t kMaxAnswers = 16;

  LiveConnection(boost::beast::tcp_stream stream, Hub& hub, Source& source);
  ~LiveConnection();
  LiveConnection(const LiveConnection&) = delete;
  LiveConnection& operator=(const LiveConnection&) = delete;

  /// Accepts a request for a WebSocket. The object then keeps itself alive until the page leaves.
  void accept(const web::Request& request);
  /// Sends the frame as soon as possible; drops a frame that is still waiting.
  void show(const Message& frame);
  void close();

 private:
  void read();
  void execute(const std::string& text);
  void answer(std::string text);
  void write_next();

  web::WebSocket socket_;
  Hub& hub_;
  Source& source_;
  std::deque<Message> answers_;  // sent before frames
  Message frame_;                // waiting
  Message writing_;              // being sent
  bool open_ = false;
};

}  // namespace tactree::viewer
