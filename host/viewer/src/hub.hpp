#pragma once
// The pages that are connected, and the way from the source's thread to them. All but offer() only
// in the server's thread.

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>

namespace tactree::viewer {

class LiveConnection;

using Message = std::shared_ptr<const std::string>;

class Hub {
 public:
  static constexpr std::size_t kMostPages = 16;

  explicit Hub(boost::asio::io_context& context) : context_(context) {}

  /// The next frame, from the source's thread. Where the one before has not been taken yet this
  /// takes its place: the thread waits for nobody, and nothing piles up.
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
