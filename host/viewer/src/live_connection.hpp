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

  /// Longest command, and most answers that wait for a page to read; one more ends the connection.
  static constexpr std::size_t kLongestCommand = 4096;
  static constexpr std::size_t kMostAnswers = 16;

  LiveConnection(boost::beast::tcp_stream stream, Hub& hub, Source& source);
  ~LiveConnection();
  LiveConnection(const LiveConnection&) = delete;
  LiveConnection& operator=(const LiveConnection&) = delete;

  /// Answers a request for a WebSocket; the connection then lives as long as the page.
  void accept(const Request& request);
  /// Sends the frame next. One that still waits is dropped for it.
  void show(const Message& frame);
  void close();

 private:
  void read();
  void obey(const std::string& text);
  void answer(std::string text);
  void write_next();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Hub& hub_;
  Source& source_;
  boost::beast::flat_buffer incoming_;
  std::deque<Message> answers_;  // go first
  Message frame_;                // the newest one that waits
  Message writing_;              // on its way
  bool open_ = false;
};

}  // namespace tactree::viewer
