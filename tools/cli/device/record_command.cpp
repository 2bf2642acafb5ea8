#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "device/board_pose.hpp"
#include "exit_codes.hpp"
#include "interruption.hpp"
#include "option_checks.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_recorder.hpp"

namespace tactree::cli {
namespace {

struct RecordOptions {
  BoardPort port;
  std::string output;
  std::string json;
  double seconds = 0.0;
  std::uint32_t every_ticks = 1;
  bool arm = false;
  std::string pose;
  int link_timeout_ms = 50;
};

constexpr std::chrono::milliseconds kBatch{50};
// Passes without telemetry, 2 s. Not counted in time, because this program may have stood still.
constexpr int kMaxSilentPasses = 40;

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

  void show(const telemetry::RecordingCounts& counts, std::chrono::microseconds now) {
    if (::isatty(STDERR_FILENO) != 0 && now >= next_) {
      next_ = now + std::chrono::seconds(1);
      shown_ = true;
      fmt::print(stderr, "\r\x1b[2K{}", telemetry::summary_of(counts));
    }
  }

 private:
  std::chrono::microseconds next_{0};
  bool shown_ = false;
};

void warn_of_slow_wire(const RecordOptions& options, const std::string& port, double rate_hz) {
  const std::optional<unsigned> bytes_s = client::wire_speed(port, options.port.baud);
  const double wanted_bytes_s = static_cast<double>(telemetry::frame_bytes()) * rate_hz;
  if (bytes_s && *bytes_s < wanted_bytes_s / options.every_ticks) {
    fmt::print(stderr,
               "tactree: warning: {}: {} baud are not enough for every tick at {:.0f} Hz, so ticks "
               "will be missing (use USB, a higher --baud, or --every {:.0f})\n",
               port, options.port.baud, rate_hz, std::ceil(wanted_bytes_s / *bytes_s));
  }
}

void warn_of_gaps(const std::string& output, const telemetry::RecordingCounts& counts) {
  if (counts.missing == 0U) {
    return;
  }
  const bool by_board = 2U * counts.omitted >= counts.missing;
  fmt::print(stderr, "tactree: warning: {}: ticks are missing, see the column missing_ticks ({})\n",
             output,
             by_board ? "the port was too slow: use USB or a higher --baud, end other programs, or "
                        "--every 2"
                      : "they were lost between the board and this program: check the cable, and "
                        "end other programs");
}

std::string reason_of_end(const client::Board& board) {
  if (!board.connected()) {
    return "the board is disconnected (connect it and record again)";
  }
  return "the board ended the session: it was reset, or another program opened one (end that "
         "program and record again)";
}

/// Records until the duration is over or Ctrl-C. Returns why it ended before that; otherwise empty.
std::string copy_telemetry(client::Board& board, telemetry::TickRecorder& recorder) {
  const client::Connection& connection = board.connection();
  ProgressLine progress;
  int silent_passes = 0;
  while (true) {
    // Sampled before the telemetry is taken, so the last pass takes all that was received.
    const bool ends = interrupted();
    const bool lost = !board.in_session();
    const std::vector<client::Telemetry> news = board.take_stream();
    if (!recorder.add(news) || ends) {
      return "";
    }
    if (lost) {
      return reason_of_end(board);
    }
    silent_passes = news.empty() ? silent_passes + 1 : 0;
    if (silent_passes > kMaxSilentPasses) {
      return "no telemetry for 2 s (is the board still running?)";
    }
    progress.show(recorder.counts(), connection.now());
    connection.sleep(kBatch);
  }
}

/// Records, and returns why it ended early. A file that cannot be extended keeps its rows.
std::string record_telemetry(client::Board& board, telemetry::TickRecorder& recorder) {
  try {
    return copy_telemetry(board, recorder);
  } catch (const support::UserError& error) {
    return error.what();
  }
}

nlohmann::json to_json(const RecordOptions& options, const telemetry::RecordingCounts& counts,
                       const std::string& problem) {
  return {{"output", options.output},
          {"ticks", counts.rows},
          {"seconds", static_cast<double>(counts.time_us) / 1e6},
          {"every_ticks", counts.every_ticks},
          {"missing_ticks", counts.missing},
          {"gaps", counts.gaps},
          {"omitted_by_board", counts.omitted},
          {"problem", problem.empty() ? nlohmann::json() : nlohmann::json(problem)}};
}

void record(const RecordOptions& options, int& exit_code) {
  watch_interruption();
  telemetry::check_tick_file(options.output);
  support::check_outputs({options.output, options.json});
  const std::string port = chosen_port(options.port);
  const int link_timeout_ms = options.arm ? options.link_timeout_ms : 0;
  client::Board board(port, {options.port.baud, static_cast<std::uint16_t>(link_timeout_ms),
                             telemetry::kStreamCapacity});
  warn_of_slow_wire(options, port, static_cast<double>(board.capabilities().rate_hz));
  if (options.arm) {
    send_pose(board, options.pose);
  }
  const std::uint32_t fields = telemetry::recorded_fields(board.connection().protocol_minor());
  telemetry::TickRecorder recorder(options.output, {fields, options.every_ticks, options.seconds});
  board.subscribe({fields, options.every_ticks});
  if (options.arm) {
    board.arm();  // after the subscription, so that no tick with a force is missing
  }
  fmt::print(stderr, "recording until {}Ctrl-C\n",
             options.seconds > 0.0 ? fmt::format("{:.6g} s have passed or ", options.seconds) : "");
  const std::string problem = record_telemetry(board, recorder);
  if (options.arm && board.in_session()) {
    board.post_stop();  // the end of the session would also stop it, but later
  }
  recorder.finish();
  fmt::print(stderr, "{}: {}\n", options.output, telemetry::summary_of(recorder.counts()));
  warn_of_gaps(options.output, recorder.counts());
  if (!options.json.empty()) {
    support::write_file(options.json,
                        support::json_text(to_json(options, recorder.counts(), problem)));
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
      app.add_subcommand("record",
                         "Records the telemetry of a board, every tick, into a file. The exit code "
                         "is 1 if the board was lost or the disk is full; the file then contains "
                         "the rows recorded so far");
  add_port_options(*verb, options->port);
  verb->add_option("-o,--output", options->output,
                   "FILE.csv, or FILE.npz for NumPy; complete at the end, FILE.incomplete before")
      ->required();
  verb->add_option("--seconds", options->seconds,
                   "end after this time on the clock of the board, s (default: on Ctrl-C)")
      ->check(is_positive);
  verb->add_option("--every", options->every_ticks, "record one tick in this many")
      ->check(within(1, 1000000))
      ->capture_default_str();
  verb->add_option("--json", options->json, "write the counts of the recording to this file");
  CLI::Option* arm = verb->add_flag(
      "--arm", options->arm, "arm the board first; stop it at the end (default: only watch it)");
  add_link_timeout_option(*verb, options->link_timeout_ms)->needs(arm);
  add_pose_option(*verb, options->pose)->needs(arm);
  verb->callback([options, &exit_code] { record(*options, exit_code); });
}

}  // namespace tactree::cli
