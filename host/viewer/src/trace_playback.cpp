#include "tactree/viewer/trace_playback.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactree/simulation/trace.hpp"

namespace tactree::viewer {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;
using simulation::Sample;
using Samples = std::vector<Sample>;

constexpr std::size_t kOverviewColumns = 1000;
constexpr std::size_t kShownTicks = 150;  // before and after the displayed tick
constexpr double kFastest = 100.0;

double force_of(const Sample& sample) {
  return static_cast<double>(core::length(sample.status.force));
}

double penetration_of(const Sample& sample) {
  const core::Rendering& r = sample.status.rendering;
  return r.in_contact ? static_cast<double>(r.penetration_m) : 0.0;
}

/// The trace in at most kOverviewColumns columns, with the minimum and maximum of each.
template <class Value>
json overview(const Samples& samples, const Value& value) {
  const std::size_t columns = std::min(kOverviewColumns, samples.size());
  json list = json::array();
  for (std::size_t column = 0; column < columns; ++column) {
    Span span;
    const std::size_t end = samples.size() * (column + 1) / columns;
    for (std::size_t i = samples.size() * column / columns; i < end; ++i) {
      span.add(value(samples[i]));
    }
    list.push_back({span.low, span.high});
  }
  return list;
}

}  // namespace

TracePlayback::TracePlayback(Samples samples, Bodies bodies, const core::DeviceModel& device,
                             const core::Vec3& model_origin_m)
    : samples_(std::move(samples)),
      bodies_(std::move(bodies)),
      device_(device),
      model_origin_m_(model_origin_m) {}

TracePlayback::~TracePlayback() { stop(); }

std::string TracePlayback::hello() const {
  const json hello = {{"type", "hello"},
                      {"source", "trace"},
                      {"models", models_json(bodies_)},
                      {"ticks", samples_.size()},
                      {"begin_s", samples_.front().t_s},
                      {"end_s", samples_.back().t_s},
                      {"overview",
                       {{"force_N", overview(samples_, force_of)},
                        {"penetration_m", overview(samples_, penetration_of)}}}};
  return hello.dump();
}

std::optional<std::string> TracePlayback::command(const json& command) {
  try {
    const std::string name = command.value("do", "");
    const auto last = static_cast<std::int64_t>(samples_.size()) - 1;
    const std::lock_guard lock(mutex_);
    if (name == "seek" || name == "step") {
      const auto now = static_cast<std::int64_t>(tick_);
      const auto wanted = name == "seek"
                              ? command.at("tick").get<std::int64_t>()
                              : now + std::clamp<std::int64_t>(
                                          command.at("ticks").get<std::int64_t>(), -last, last);
      tick_ = static_cast<std::size_t>(std::clamp<std::int64_t>(wanted, 0, last));
      speed_ = 0.0;
    } else if (name == "play") {
      const double speed = command.at("speed").get<double>();
      if (!(speed >= 0.0 && speed <= kFastest)) {
        return "speed: outside 0 .. 100";
      }
      speed_ = speed;
      tick_ = tick_ == static_cast<std::size_t>(last) ? 0 : tick_;
      time_s_ = samples_[tick_].t_s;
    } else if (name == "stop") {
      speed_ = 0.0;
    } else {
      return "'" + name + "': unknown command (a trace has seek, step, play, stop)";
    }
    return std::nullopt;
  } catch (const json::exception& error) {
    return error.what();
  }
}

std::string TracePlayback::trace_csv() const {
  std::string csv = simulation::trace_heading();
  for (const Sample& sample : samples_) {
    simulation::append_trace(csv, sample);
  }
  return csv;
}

void TracePlayback::run(const Publish& publish) {
  const std::chrono::duration<double> period(1.0 / kFrameRate_hz);
  while (running()) {
    const Clock::time_point now = Clock::now();
    std::size_t tick = 0;
    double speed = 0.0;
    {
      const std::lock_guard lock(mutex_);
      play(period.count());
      tick = tick_;
      speed = speed_;
    }
    publish(std::make_shared<const std::string>(frame(tick, speed)));
    std::this_thread::sleep_until(now + period);
  }
}

void TracePlayback::play(double seconds) {
  if (speed_ <= 0.0) {
    return;
  }
  time_s_ += speed_ * seconds;
  while (tick_ + 1 < samples_.size() && samples_[tick_ + 1].t_s <= time_s_) {
    ++tick_;
  }
  speed_ = tick_ + 1 < samples_.size() ? speed_ : 0.0;
}

std::string TracePlayback::frame(std::size_t tick, double speed) {
  const Sample& sample = samples_[tick];
  const json run =
      run_json(sample, "trace", device_, model_origin_m_, std::nullopt, bodies_, scratch_);
  const json frame = {{"type", "frame"},
                      {"tick", tick},
                      {"t_s", sample.t_s},
                      {"playing", speed},
                      {"runs", json::array({run})},
                      {"around", around(tick)},
                      {"work", unknown_work("A trace does not record the work per tick.")},
                      {"bodies", poses_json(bodies_, sample.t_s)}};
  return frame.dump();
}

json TracePlayback::around(std::size_t tick) const {
  const std::size_t begin = tick - std::min(tick, kShownTicks);
  const std::size_t end = std::min(samples_.size(), tick + kShownTicks + 1);
  json force = json::array();
  json penetration = json::array();
  for (std::size_t i = begin; i < end; ++i) {
    force.push_back(force_of(samples_[i]));
    penetration.push_back(penetration_of(samples_[i]));
  }
  return {{"first", begin}, {"force_N", force}, {"penetration_m", penetration}};
}

}  // namespace tactree::viewer
