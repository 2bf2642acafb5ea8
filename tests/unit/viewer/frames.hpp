#pragma once
// Frames of a source, as a page receives them.

#include <gtest/gtest.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>

#include "tactree/viewer/source.hpp"

namespace tactree::test {

/// Waits for frames as a page does.
class Frames {
 public:
  viewer::Source::Publish taker() {
    return [this](const std::shared_ptr<const std::string>& text) {
      const std::lock_guard lock(mutex_);
      newest_ = nlohmann::json::parse(*text);
      ++count_;
      changed_.notify_all();
    };
  }
  /// The first frame from now on for which this holds; it has to come.
  nlohmann::json wait_for(const std::function<bool(const nlohmann::json&)>& holds) {
    std::unique_lock lock(mutex_);
    for (int i = 0; i < 3000; ++i) {
      const auto before = count_;
      changed_.wait(lock, [&] { return count_ != before; });
      if (holds(newest_)) {
        return newest_;
      }
    }
    ADD_FAILURE() << "it never happened: " << newest_.dump().substr(0, 600);
    return newest_;
  }
  nlohmann::json wait_for_state(const std::string& state) {
    return wait_for(
        [&](const nlohmann::json& frame) { return frame["runs"][0]["state"] == state; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  nlohmann::json newest_;
  std::uint64_t count_ = 0;
};

}  // namespace tactree::test
