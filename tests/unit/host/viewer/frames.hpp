#pragma once
// Frames of a source, as a page receives them.

#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactree/viewer/source.hpp"

namespace tactree::test {

/// Waits for frames as a page does; sees every one of them.
class Frames {
 public:
  viewer::Source::Publish taker() {
    return [this](const web::Message& text) {
      nlohmann::json frame = nlohmann::json::parse(*text);
      const std::lock_guard lock(mutex_);
      unseen_.push_back(std::move(frame));
      changed_.notify_all();
    };
  }
  /// The first frame from now on for which this holds; it has to come.
  nlohmann::json wait_for(const std::function<bool(const nlohmann::json&)>& holds) {
    {
      const std::lock_guard lock(mutex_);
      unseen_.clear();
    }
    nlohmann::json frame;
    for (int i = 0; i < 3000; ++i) {
      frame = next();
      if (holds(frame)) {
        return frame;
      }
    }
    ADD_FAILURE() << "it never happened: " << frame.dump().substr(0, 600);
    return frame;
  }
  nlohmann::json wait_for_state(const std::string& state) {
    return wait_for(
        [&](const nlohmann::json& frame) { return frame["runs"][0]["state"] == state; });
  }

 private:
  nlohmann::json next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !unseen_.empty(); });
    nlohmann::json frame = std::move(unseen_.front());
    unseen_.pop_front();
    return frame;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<nlohmann::json> unseen_;
};

}  // namespace tactree::test
