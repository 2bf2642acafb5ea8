#include "stage_times.hpp"

#include <sys/resource.h>

#include <chrono>
#include <utility>

namespace tactree::builder {

Usage usage_of_process() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(now).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U};
}

StageTimes::StageTimes(Progress& progress, std::function<Usage()> read)
    : progress_(progress), read_(std::move(read)), start_(read_()) {}

void StageTimes::begin(std::string_view name) {
  close();
  begin_ = read_();
  open_ = true;
  stages_.push_back({.name = std::string(name)});
  progress_.begin(name);
}

void StageTimes::end() {
  close();
  progress_.end();
}

void StageTimes::set_points(std::uint64_t points) {
  if (open_) {
    stages_.back().points = points;
  }
}

void StageTimes::close() {
  if (!open_) {
    return;
  }
  const Usage now = read_();
  StageReport& stage = stages_.back();
  stage.seconds = now.wall_s - begin_.wall_s;
  stage.cpu_seconds = now.cpu_s - begin_.cpu_s;
  stage.peak_rss_bytes = now.peak_rss_bytes;
  open_ = false;
}

}  // namespace tactree::builder
