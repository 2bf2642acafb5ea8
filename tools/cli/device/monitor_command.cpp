#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "exit_codes.hpp"
#include "interruption.hpp"
#include "option_checks.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct MonitorOptions {
  BoardPort port;
  std::string json;
  bool once = false;
  double seconds = 0.0;
};

constexpr int kBarWidth = 40;
constexpr double kRefreshS = 0.1;

std::string names_of_limits(std::uint32_t limits) {
  std::string names;
  for (std::uint32_t i = 0; i < core::kLimits; ++i) {
    if ((limits & (1U << i)) != 0U) {
      names +=
          std::string(names.empty() ? "" : ", ") + core::name_of(static_cast<core::Limit>(1U << i));
    }
  }
  return names;
}

double length(const float (&v)[3]) {
  return std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]),
                    static_cast<double>(v[2]));
}

/// Ticks per second of the board's clock.
double rate_of(const client::Telemetry& from, const client::Telemetry& to) {
  const std::uint32_t us = to.header.board_time_us - from.header.board_time_us;
  return us == 0U ? 0.0 : 1e6 * static_cast<double>(to.header.tick - from.header.tick) / us;
}

struct View {
  client::Telemetry now{};
  double rate_hz = 0.0;
  double force_max_N = 0.0;
  std::uint32_t cycles_per_tick = 0;
  bool work_is_reduced = false;
  bool watch_only = false;
  bool shared = false;
  std::uint64_t dropped = 0;
};

std::string cycles(const View& view) {
  if (view.cycles_per_tick == 0U) {
    return "";
  }
  return fmt::format(", {:.0f} of {} cycles",
                     static_cast<double>(view.now.load) * view.cycles_per_tick,
                     view.cycles_per_tick);
}

std::string to_text(const View& view) {
  const client::Telemetry& t = view.now;
  const double force = length(t.force_N);
  const double share = view.force_max_N > 0.0 ? std::min(1.0, force / view.force_max_N) : 0.0;
  const int filled = static_cast<int>(std::lround(share * kBarWidth));
  const std::string faults = client::names_of(t.faults);
  const std::string limits = names_of_limits(t.limits);
  return fmt::format(
      "state    {}{}{}\n"
      "force    {:7.3f} N [{}{}] {:.3g} N\n"
      "motors   {:7.3f} N at the probe: with {:.3f} N of gravity compensation, {:.3f} N added\n"
      "probe    {:9.4f} {:9.4f} {:9.4f} m   speed {:.3f} m/s\n"
      "contact  {}\n"
      "ticks    {:.0f} per second, load {:.1f} %{}{}, overruns {}, telemetry dropped {}\n"
      "faults   {}\n",
      core::name_of(static_cast<core::State>(t.state)),
      limits.empty() ? "" : " (limited by: " + limits + ")",
      view.shared       ? ", shared by tactree serve: this program may watch and stop"
      : view.watch_only ? ", operated by its button: a program may watch and stop"
                        : "",
      force, std::string(static_cast<std::size_t>(filled), '#'),
      std::string(static_cast<std::size_t>(kBarWidth - filled), ' '), view.force_max_N,
      length(t.motors_N), length(t.gravity_N), length(t.added_N), t.probe_m[0], t.probe_m[1],
      t.probe_m[2], length(t.velocity_m_s),
      t.body == core::kNoBody ? "none"
                              : fmt::format("body {}, {:.3f} mm deep", t.body,
                                            1e3 * static_cast<double>(t.penetration_m)),
      view.rate_hz, 100.0 * static_cast<double>(t.load), cycles(view),
      view.work_is_reduced ? ", work reduced" : "", t.overruns, view.dropped,
      faults.empty() ? "none" : faults);
}

nlohmann::json to_json(const View& view) {
  const client::Telemetry& t = view.now;
  return {{"tick", t.header.tick},
          {"state", core::name_of(static_cast<core::State>(t.state))},
          {"faults", t.faults},
          {"fault_names", client::names_of(t.faults)},
          {"limits", t.limits},
          {"force_N", t.force_N},
          {"motor_force_N", t.motors_N},
          {"gravity_force_N", t.gravity_N},
          {"added_force_N", t.added_N},
          {"probe_m", t.probe_m},
          {"velocity_m_s", t.velocity_m_s},
          {"in_contact", t.body != core::kNoBody},
          {"penetration_m", t.penetration_m},
          {"rate_hz", view.rate_hz},
          {"load", t.load},
          {"overruns", t.overruns},
          {"work_is_reduced", view.work_is_reduced},
          {"watch_only", view.watch_only},
          {"shared", view.shared},
          {"dropped", view.dropped}};
}

class NoTelemetry : public support::UserError {
 public:
  using support::UserError::UserError;
};

constexpr std::uint32_t kFields =
    core::wire::kAllTelemetry & ~static_cast<std::uint32_t>(core::wire::TelemetryField::kReactions);

class Monitor {
 public:
  explicit Monitor(client::Board& board) : board_(board) {
    const core::wire::CapabilitiesReply can = board_.capabilities();
    view_.force_max_N = static_cast<double>(can.force_max_N);
    view_.cycles_per_tick = can.cycles_per_tick;
    view_.work_is_reduced = has_flag(can, core::wire::BoardFlag::kWorkReduced);
    view_.watch_only = has_flag(can, core::wire::BoardFlag::kWatchOnly);
    view_.shared = has_flag(can, core::wire::BoardFlag::kShared);
    // Fifty messages per second are readable and leave bandwidth on a serial port.
    const auto every = static_cast<std::uint32_t>(std::max(1.0F, can.rate_hz / 50.0F));
    board_.subscribe({kFields, every});
  }

  /// Throws NoTelemetry if no telemetry arrives.
  const View& look() {
    const client::Connection& connection = board_.connection();
    const auto wait_until = connection.now() + std::chrono::seconds(2);
    std::vector<client::Telemetry> news = board_.take_stream();
    while (news.size() < 2U) {
      if (!board_.connected() || connection.now() > wait_until) {
        throw NoTelemetry("no telemetry (is the board still connected?)");
      }
      connection.sleep(std::chrono::milliseconds(10));
      const std::vector<client::Telemetry> more = board_.take_stream();
      news.insert(news.end(), more.begin(), more.end());
    }
    view_.rate_hz = rate_of(news.front(), news.back());
    view_.now = news.back();
    view_.dropped = board_.dropped();
    return view_;
  }

 private:
  client::Board& board_;
  View view_;
};

/// Waits until the board is connected again. Returns false if the time is up or Ctrl-C was pressed.
template <class TimeIsUp>
bool wait_for_return(client::Board& board, TimeIsUp time_is_up) {
  fmt::print("the board is disconnected; waiting for it\n");
  std::fflush(stdout);
  while (!time_is_up()) {
    try {
      board.reconnect();
      fmt::print("the board is connected again\n");
      return true;
    } catch (const client::LinkError&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  }
  return false;
}

/// Prints a view: on a terminal over the previous view, in a file or pipe after it, separated by an
/// empty line.
void print_view(const std::string& text, bool first) {
  if (isatty(STDOUT_FILENO) == 0) {
    fmt::print("{}{}", first ? "" : "\n", text);
  } else {
    fmt::print("{}", first ? "" : "\x1b[7A");
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t line_end = text.find('\n', at);
      fmt::print("\x1b[2K{}\n", text.substr(at, line_end - at));
      at = line_end + 1;
    }
  }
  std::fflush(stdout);
}

void watch(client::Board& board, Monitor& monitor, const MonitorOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> limit(options.seconds);
  const auto time_is_up = [&] {
    return interrupted() ||
           (options.seconds > 0.0 && std::chrono::steady_clock::now() - begin >= limit);
  };
  bool first = true;
  while (!time_is_up()) {
    std::string text;
    try {
      text = to_text(monitor.look());
    } catch (const NoTelemetry&) {
      if (!wait_for_return(board, time_is_up)) {
        return;
      }
      first = true;
      continue;
    }
    print_view(text, first);
    first = false;
    std::this_thread::sleep_for(std::chrono::duration<double>(kRefreshS));
  }
}

void show(const MonitorOptions& options, int& exit_code) {
  watch_interruption();
  const auto board = connect(options.port);
  Monitor monitor(*board);
  if (!options.once) {
    return watch(*board, monitor, options);
  }
  const View& view = monitor.look();
  fmt::print("{}", to_text(view));
  if (!options.json.empty()) {
    support::write_file(options.json, to_json(view).dump(2) + "\n");
  }
  exit_code = view.now.faults == 0U ? kExitOk : kExitFailed;
}

}  // namespace

void add_monitor_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<MonitorOptions>();
  CLI::App* verb = app.add_subcommand("monitor", "Shows state, force and faults of a board, live");
  add_port_options(*verb, options->port);
  CLI::Option* once = verb->add_flag("--once", options->once,
                                     "print the values once; exit code 1 if a fault is latched");
  verb->add_option("--json", options->json, "also write the values to this file")->needs(once);
  verb->add_option("--seconds", options->seconds, "end after this time, s (default: on Ctrl-C)")
      ->check(is_positive);
  verb->callback([options, &exit_code] { show(*options, exit_code); });
}

}  // namespace tactree::cli
