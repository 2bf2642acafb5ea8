#include "hub.hpp"

#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "live_connection.hpp"

namespace tactree::viewer {

void Hub::offer(Message frame) {
  ++offered_;
  const std::lock_guard lock(mutex_);
  const bool idle = newest_ == nullptr;
  newest_ = std::move(frame);
  if (idle) {
    boost::asio::post(context_, [this] { take(); });
  }
}

void Hub::take() {
  Message frame;
  {
    const std::lock_guard lock(mutex_);
    frame = std::exchange(newest_, nullptr);
  }
  for (LiveConnection* const page : pages_) {
    page->show(frame);
  }
}

bool Hub::join(LiveConnection* page) {
  return pages_.size() < kMaxPages && pages_.insert(page).second;
}

void Hub::close_all() {
  const std::vector<LiveConnection*> pages(pages_.begin(), pages_.end());
  for (LiveConnection* const page : pages) {
    page->close();
  }
}

std::string Hub::status_json() const {
  const nlohmann::json json = {
      {"pages", pages_.size()},
      {"frames", {{"offered", offered_.load()}, {"sent", sent_}, {"dropped", dropped_}}}};
  return json.dump();
}

}  // namespace tactree::viewer
