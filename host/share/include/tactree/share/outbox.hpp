#pragma once
// The states that wait for a client which has subscribed. Bounded: if the client does not take them
// in time, the oldest are dropped and counted, so it gets the newest.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "tactree/web/types.hpp"

namespace tactree::share {

using web::Message;

class Outbox {
 public:
  /// One tick of `every_ticks`, of which up to `capacity` wait. every_ticks 0: ends it.
  void subscribe(std::uint32_t every_ticks, std::size_t capacity) {
    every_ticks_ = every_ticks;
    capacity_ = std::max<std::size_t>(capacity, 1);
    last_tick_.reset();
    waiting_.clear();
  }
  [[nodiscard]] std::uint32_t every_ticks() const { return every_ticks_; }
  [[nodiscard]] bool is_due(std::uint32_t tick) const {
    return every_ticks_ != 0U && (!last_tick_ || tick - *last_tick_ >= every_ticks_);
  }

  void push(Message state, std::uint32_t tick) {
    last_tick_ = tick;
    if (waiting_.size() >= capacity_) {
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back(std::move(state));
  }
  /// The oldest; nullptr if none waits.
  [[nodiscard]] Message pop() {
    if (waiting_.empty()) {
      return nullptr;
    }
    Message state = std::move(waiting_.front());
    waiting_.pop_front();
    return state;
  }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::uint32_t every_ticks_ = 0;
  std::size_t capacity_ = 1;
  std::optional<std::uint32_t> last_tick_;
  std::deque<Message> waiting_;
  std::uint64_t dropped_ = 0;
};

}  // namespace tactree::share
