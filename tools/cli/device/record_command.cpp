#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "exit_codes.hpp"
#include "interruption.hpp"
#include "option_checks.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_file.hpp"

namespace tactree::cli {
namespace {

struct RecordOptions {
  BoardPort port;
  std::string output;
  double seconds = 0.0;
  std::uint32_t every_ticks = 1;
  bool arm = false;
  int link_timeout_ms = 50;
};

// Bytes of a frame with the recorded fields.
constexpr double kFrameBytes = 176.0;
// Messages that wait while the disk is slow: 16 s at 4 kHz, about 12 MB.
constexpr std::size_t kStreamCapacity = 65536;
constexpr std::chrono::milliseconds kBatch{50};
constexpr std::chrono::seconds kMaxSilence{2};

/// Appends the telemetry of a board to a file, and counts.
class Recording {
 public:
  explicit Recording(const RecordOptions& options)
      : file_(telemetry::open_tick_file(options.output)),
        sequence_(options.every_ticks),
        end_us_(1e6 * options.seconds) {}

  /// Returns false once the duration is over.
  bool add(const std::vector<client::Telemetry>& news) {
    std::vector<telemetry::Tick> rows;
    bool goes_on = true;
    for (const client::Telemetry& message : news) {
      const std::optional<telemetry::Tick> tick = sequence_.next(message);
      if (!tick) {
        continue;
      }
      if (end_us_ > 0.0 && static_cast<double>(tick->time_us) >= end_us_) {
        goes_on = false;
        break;
      }
      rows.push_back(*tick);
    }
    file_->append(rows);
    for (const telemetry::Tick& row : rows) {
      count(row);
    }
    return goes_on;
  }

  void finish() { file_->finish(); }

  [[nodiscard]] bool has_gaps() const { return gaps_ != 0U; }
  [[nodiscard]] std::string summary() const {
    return fmt::format(
        "{} ticks in {:.3f} s, {}", ticks_, 1e-6 * static_cast<double>(last_us_),
        has_gaps() ? fmt::format("{} missing in {} gaps", missing_, gaps_) : "none missing");
  }

 private:
  void count(const telemetry::Tick& row) {
    ++ticks_;
    missing_ += row.missing_ticks;
    gaps_ += row.missing_ticks == 0U ? 0U : 1U;
    last_us_ = row.time_us;
  }

  std::unique_ptr<telemetry::TickFile> file_;
  telemetry::TickSequence sequence_;
  double end_us_;  // 0: no end
  std::uint64_t ticks_ = 0;
  std::uint64_t missing_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t last_us_ = 0;
};

/// One line on a terminal, once a second.
class ProgressLine {
 public:
  ~ProgressLine() {
    if (shown_) {
      (void)std::fputc('\n', stderr);
    }
  }
  ProgressLine() = default;
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Recording& recording, std::chrono::microseconds now) {
    if (::isatty(STDERR_FILENO) != 0 && now >= next_) {
      next_ = now + std::chrono::seconds(1);
      shown_ = true;
      fmt::print(stderr, "\r\x1b[2K{}", recording.summary());
    }
  }

 private:
  std::chrono::microseconds next_{0};
  bool shown_ = false;
};

void warn_of_slow_wire(const RecordOptions& options, const std::string& port, double rate_hz) {
  const std::optional<unsigned> bytes_s = client::wire_speed(port, options.port.baud);
  if (bytes_s && *bytes_s < kFrameBytes * rate_hz / options.every_ticks) {
    fmt::print(stderr,
               "tactree: warning: {}: {} baud are not enough for every tick at {:.0f} Hz, so ticks "
               "will be missing (use USB, a higher --baud, or --every {:.0f})\n",
               port, options.port.baud, rate_hz, std::ceil(kFrameBytes * rate_hz / *bytes_s));
  }
}

std::string reason_of_end(const client::Board& board) {
  if (!board.connected()) {
    return "the board is disconnected (connect it and record again)";
  }
  return "the board ended the session: it was reset, or another program opened one (end that "
         "program and record again)";
}

/// Records until the duration is over or Ctrl-C. Returns why it ended before that; otherwise empty.
std::string copy_telemetry(const client::Board& board, Recording& recording) {
  const client::Connection& connection = board.connection();
  ProgressLine progress;
  auto silent_since = connection.now();
  while (true) {
    // Sampled before the telemetry is taken, so the last pass takes all that was received.
    const bool ends = interrupted();
    const bool lost = !board.in_session();
    const std::vector<client::Telemetry> news = board.connection().take_stream();
    if (!recording.add(news) || ends) {
      return "";
    }
    if (lost) {
      return reason_of_end(board);
    }
    silent_since = news.empty() ? silent_since : connection.now();
    if (connection.now() - silent_since > kMaxSilence) {
      return "no telemetry for 2 s (is the board still running?)";
    }
    progress.show(recording, connection.now());
    connection.sleep(kBatch);
  }
}

/// Records, and returns why it ended early. A file that cannot be extended keeps its rows.
std::string record_telemetry(const client::Board& board, Recording& recording) {
  try {
    return copy_telemetry(board, recording);
  } catch (const support::UserError& error) {
    return error.what();
  }
}

void record(const RecordOptions& options, int& exit_code) {
  watch_interruption();
  telemetry::check_tick_file(options.output);
  support::check_outputs({options.output});
  const std::string port = chosen_port(options.port);
  const int link_timeout_ms = options.arm ? options.link_timeout_ms : 0;
  client::Board board(
      port, {options.port.baud, static_cast<std::uint16_t>(link_timeout_ms), kStreamCapacity});
  warn_of_slow_wire(options, port, static_cast<double>(board.capabilities().rate_hz));
  if (options.arm) {
    board.arm();
  }
  Recording recording(options);
  board.subscribe({telemetry::kRecordedFields, options.every_ticks});
  fmt::print(stderr, "recording until {}Ctrl-C\n",
             options.seconds > 0.0 ? fmt::format("{:.6g} s have passed or ", options.seconds) : "");
  const std::string problem = record_telemetry(board, recording);
  if (options.arm && board.in_session()) {
    board.post_stop();  // the end of the session would also stop it, but later
  }
  recording.finish();
  fmt::print(stderr, "{}: {}\n", options.output, recording.summary());
  if (recording.has_gaps()) {
    fmt::print(
        stderr,
        "tactree: warning: {}: ticks are missing, see the column missing_ticks (use USB or a "
        "higher --baud, end other programs, or --every 2)\n",
        options.output);
  }
  if (!problem.empty()) {
    fmt::print(stderr, "tactree: error: {}: the recording ended early: {}\n", port, problem);
    exit_code = kExitFailed;
  }
}

}  // namespace

void add_record_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* verb =
      app.add_subcommand("record", "Records the telemetry of a board, every tick, into a file");
  add_port_options(*verb, options->port);
  verb->add_option("-o,--output", options->output,
                   "FILE.csv, or FILE.npz for NumPy; complete at the end, FILE.incomplete before")
      ->required();
  verb->add_option("--seconds", options->seconds,
                   "end after this time of the board, s (default: on Ctrl-C)")
      ->check(is_positive);
  verb->add_option("--every", options->every_ticks, "record one tick of this many")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  CLI::Option* arm =
      verb->add_flag("--arm", options->arm, "arm the board first; stop it at the end");
  add_link_timeout_option(*verb, options->link_timeout_ms)->needs(arm);
  verb->callback([options, &exit_code] { record(*options, exit_code); });
}

}  // namespace tactree::cli
