#include "tactree/viewer/tick_log.hpp"

#include "tactree/simulation/trace.hpp"

namespace tactree::viewer {

void TickLog::add(const simulation::Sample& sample) {
  filling_.push_back(sample);
  if (filling_.size() == kChunkTicks) {
    publish();
  }
}

void TickLog::publish() {
  auto chunk = std::make_shared<const Chunk>(std::move(filling_));
  filling_ = {};
  filling_.reserve(kChunkTicks);
  const std::lock_guard lock(mutex_);
  full_.push_back(std::move(chunk));
  if (full_.size() > kMaxTicks / kChunkTicks) {
    full_.pop_front();
  }
}

void TickLog::clear() {
  filling_.clear();
  const std::lock_guard lock(mutex_);
  full_.clear();
}

std::string TickLog::csv() const {
  std::deque<std::shared_ptr<const Chunk>> chunks;
  {
    const std::lock_guard lock(mutex_);
    chunks = full_;
  }
  std::string csv = simulation::trace_heading();
  for (const auto& chunk : chunks) {
    for (const simulation::Sample& sample : *chunk) {
      simulation::append_trace(csv, sample);
    }
  }
  return csv;
}

}  // namespace tactree::viewer
