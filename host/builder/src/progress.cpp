#include "tactree/builder/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>

namespace tactree::builder {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class TerminalProgress : public Progress {
 public:
  explicit TerminalProgress(std::FILE* stream) : stream_(stream) {}
  ~TerminalProgress() override { wipe(); }
  void begin(std::string_view name) override {
    name_ = name;
    begin_ = Clock::now();
    show_after_s_ = 0.0;
    show(-1.0);
  }
  void advance(double fraction) override { show(fraction); }
  void end() override { wipe(); }

 private:
  void show(double fraction) {
    const double elapsed_s = seconds_since(begin_);
    if (elapsed_s < show_after_s_) {
      return;
    }
    show_after_s_ = elapsed_s + 0.1;
    dirty_ = true;
    std::fprintf(stream_, "\r\033[K%s", progress_line(name_, fraction, elapsed_s).c_str());
    std::fflush(stream_);
  }
  void wipe() {
    if (dirty_) {
      std::fputs("\r\033[K", stream_);
      std::fflush(stream_);
      dirty_ = false;
    }
  }

  std::FILE* stream_;
  std::string name_;
  Clock::time_point begin_ = Clock::now();  // of the step
  double show_after_s_ = 0.0;               // of the step
  bool dirty_ = false;
};

class PlainProgress : public Progress {
 public:
  explicit PlainProgress(std::FILE* stream) : stream_(stream) {}
  void begin(std::string_view name) override {
    std::fprintf(stream_, "%8.2f s  %.*s\n", seconds_since(start_), static_cast<int>(name.size()),
                 name.data());
    std::fflush(stream_);
  }

 private:
  std::FILE* stream_;
  Clock::time_point start_ = Clock::now();
};

std::string json_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + '"';
}

class JsonProgress : public Progress {
 public:
  explicit JsonProgress(std::FILE* stream) : stream_(stream) {}
  void begin(std::string_view name) override {
    name_ = json_text(name);
    reported_ = 0.0;
    write_line();
  }
  void advance(double fraction) override {
    if (fraction >= reported_ + 0.05) {
      reported_ = fraction;
      write_line();
    }
  }
  void end() override {
    if (!name_.empty()) {
      reported_ = 1.0;
      write_line();
    }
    name_.clear();
  }

 private:
  void write_line() {
    std::fprintf(stream_, "{\"step\": %s, \"fraction\": %.2f, \"seconds\": %.3f}\n", name_.c_str(),
                 reported_, seconds_since(start_));
    std::fflush(stream_);
  }

  std::FILE* stream_;
  Clock::time_point start_ = Clock::now();
  std::string name_;
  double reported_ = 0.0;
};

}  // namespace

void Progress::begin(std::string_view) {}
void Progress::advance(double) {}
void Progress::end() {}

std::string progress_line(std::string_view name, double fraction, double elapsed_s) {
  constexpr double kEstimateAfter_s = 1.0;
  if (!(fraction >= 0.0)) {
    return fmt::format("{} ...", name);
  }
  std::string line = fmt::format("{} {:.0f} %", name, std::floor(100.0 * fraction));
  if (elapsed_s >= kEstimateAfter_s && fraction > 0.0 && fraction < 1.0) {
    line += fmt::format(", {:.0f} s left", std::ceil(elapsed_s * (1.0 - fraction) / fraction));
  }
  return line;
}

std::unique_ptr<Progress> make_progress(ProgressStyle style, std::FILE* stream) {
  switch (style) {
    case ProgressStyle::kPlain:
      return std::make_unique<PlainProgress>(stream);
    case ProgressStyle::kJson:
      return std::make_unique<JsonProgress>(stream);
    case ProgressStyle::kAuto:
      if (::isatty(::fileno(stream)) == 1) {
        return std::make_unique<TerminalProgress>(stream);
      }
      break;
    case ProgressStyle::kOff:
      break;
  }
  return std::make_unique<Progress>();
}

}  // namespace tactree::builder
