#pragma once
// The last ticks of a session, for a trace. One thread adds ticks; any thread may read a copy
// without delaying it, because full chunks are immutable and shared.

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tactree/simulation/simulation.hpp"

namespace tactree::viewer {

class TickLog {
 public:
  static constexpr std::size_t kChunkTicks = 500;
  /// About 25 MB; one minute at 1 kHz.
  static constexpr std::size_t kMaxTicks = 60000;

  void add(const simulation::Sample& sample);
  /// Begins a new trace.
  void clear();
  [[nodiscard]] std::string csv() const;

 private:
  using Chunk = std::vector<simulation::Sample>;

  void publish();

  Chunk filling_;
  mutable std::mutex mutex_;  // guards full_
  std::deque<std::shared_ptr<const Chunk>> full_;
};

}  // namespace tactree::viewer
