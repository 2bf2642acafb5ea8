#pragma once
// The last ticks of a session, for a trace. One thread writes, any thread may take a copy without
// holding the writer up: full chunks never change and are shared.

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
  /// Some 25 MB of samples; a minute at 1 kHz.
  static constexpr std::size_t kMostTicks = 60000;

  void add(const simulation::Sample& sample);
  /// Another session begins: its ticks are not of the old one's trace.
  void clear();
  [[nodiscard]] std::string csv() const;

 private:
  using Chunk = std::vector<simulation::Sample>;

  void publish();

  Chunk filling_;
  mutable std::mutex mutex_;  // guards what follows
  std::deque<std::shared_ptr<const Chunk>> full_;
};

}  // namespace tactree::viewer
