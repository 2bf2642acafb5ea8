#pragma once
// Passes frames from the source's thread to the connected pages. All functions except offer() must
// be called from the server's thread.

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>

#include "tactree/web/types.hpp"

namespace tactree::viewer {

class LiveConnection;

using web::Message;

class Hub {
 public:
  static constexpr std::size_t kMaxPages = 16;

  explicit Hub(boost::asio::io_context& context) : context_(context) {}

  /// Offers the next frame; called from the source's thread. Replaces a frame that has not been
  /// sent yet, so that the thread never waits and no queue grows.
  void offer(Message frame);

  [[nodiscard]] bool join(LiveConnection* page);
  void leave(LiveConnection* page) { pages_.erase(page); }
  void close_all();

  void count_sent() { ++sent_; }
  void count_dropped() { ++dropped_; }
  /// {"pages": n, "frames": {"offered": n, "sent": n, "dropped": n}}
  [[nodiscard]] std::string status_json() const;

 private:
  void take();

  boost::asio::io_context& context_;
  std::mutex mutex_;
  Message newest_;
  std::atomic<std::uint64_t> offered_{0};
  std::set<LiveConnection*> pages_;
  std::uint64_t sent_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace tactree::viewer
