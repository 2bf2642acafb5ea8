#include "dry_run.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>

#include "exit_codes.hpp"
#include "real_time.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/hal/linux/function_fs_controller.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::controller {
namespace {

namespace gpio = hal::linux_gpio;

/// One row of the table. `look` returns the detail, or throws an exception with it.
Finding row(const std::string& what, const std::string& which,
            const std::function<std::string()>& look) {
  try {
    return {what, which, true, true, look()};
  } catch (const std::exception& error) {
    return {what, which, false, true, error.what()};
  }
}

std::string look_at_line(const std::string& name) {
  const gpio::LinePlace place = gpio::find_line(name);
  if (place.used) {
    throw gpio::GpioError(fmt::format("{} line {}: in use by '{}' (hint: end that program)",
                                      place.chip, place.offset, place.user));
  }
  return fmt::format("{} line {}, free", place.chip, place.offset);
}

const std::string& good_line(const gpio::ControllerBoardSettings& board) {
  return board.converters.axes.empty() ? board.motors.good : board.converters.good;
}

void examine_lines(const gpio::ControllerBoardSettings& board, std::vector<Finding>& findings) {
  const auto line = [&findings](const std::string& what, const std::string& name) {
    if (!name.empty()) {
      findings.push_back(row(what, name, [&name] { return look_at_line(name); }));
    }
  };
  line("enable", board.enable);
  line("brake", board.brake);
  line("enable read-back", board.enable_read_back);
  line("emergency stop", board.emergency_stop);
  line("dead-man", board.dead_man);
  line("heartbeat", board.heartbeat);
  for (std::size_t i = 0; i < board.encoders.size(); ++i) {
    line(fmt::format("encoder {} a", i), board.encoders[i].a);
    line(fmt::format("encoder {} b", i), board.encoders[i].b);
    line(fmt::format("encoder {} index", i), board.encoders[i].index);
  }
  for (std::size_t i = 0; i < board.motors.axes.size(); ++i) {
    line(fmt::format("direction {}", i), board.motors.axes[i].direction);
  }
  line("amplifiers good", good_line(board));
}

/// The encoder lines are read simultaneously, so they must be on the same chip. Brake and enable
/// line must also be on the same chip.
void examine_banks(const gpio::ControllerBoardSettings& board, std::vector<Finding>& findings) {
  findings.push_back(row("lines of a bank", "one chip each", [&board] {
    std::string chip;
    for (const gpio::EncoderLines& axis : board.encoders) {
      for (const std::string& name : {axis.a, axis.b, axis.index}) {
        const std::string found = name.empty() ? chip : gpio::find_line(name).chip;
        if (!chip.empty() && found != chip) {
          throw gpio::GpioError(fmt::format(
              "line '{}' is on {}, but other encoder lines are on {} (hint: use lines of one chip)",
              name, found, chip));
        }
        chip = found;
      }
    }
    return chip.empty() ? std::string("encoders at counters") : "encoders on " + chip;
  }));
  if (!board.brake.empty()) {
    findings.push_back(row("brake", "on the chip of enable", [&board] {
      const std::string chip = gpio::find_line(board.enable).chip;
      const std::string found = gpio::find_line(board.brake).chip;
      if (found != chip) {
        throw gpio::GpioError(
            fmt::format("line '{}' is on {}, but line '{}' is on {} (hint: use lines of one chip)",
                        board.brake, found, board.enable, chip));
      }
      return chip;
    }));
  }
}

void examine_names(const gpio::ControllerBoardSettings& board, std::vector<Finding>& findings) {
  std::vector<std::string> names = {board.enable,    board.enable_read_back, board.emergency_stop,
                                    board.dead_man,  board.heartbeat,        board.brake,
                                    good_line(board)};
  for (const gpio::EncoderLines& axis : board.encoders) {
    names.insert(names.end(), {axis.a, axis.b, axis.index});
  }
  for (const gpio::MotorLines& axis : board.motors.axes) {
    names.push_back(axis.direction);
  }
  std::erase(names, std::string());
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  findings.push_back(row("names", "each once", [&] {
    if (twice != names.end()) {
      throw gpio::GpioError(fmt::format(
          "line '{}' is given twice (hint: use a separate line for each signal)", *twice));
    }
    return fmt::format("{} lines", names.size());
  }));
}

std::string need_writable(const std::string& file) {
  if (access(file.c_str(), W_OK) != 0) {
    const int error = errno;
    throw support::UserError(fmt::format("{}: {} (hint: {})", file, std::strerror(error),
                                         error == ENOENT
                                             ? "create it, or load its driver"
                                             : "run as root, or join the group that owns it"));
  }
  return file;
}

void examine_counters(const gpio::CounterSettings& counters, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < counters.axes.size(); ++i) {
    const gpio::CounterAxis& axis = counters.axes[i];
    findings.push_back(row(fmt::format("encoder {}", i),
                           fmt::format("{} count {}", axis.device, axis.count), [&counters, &axis] {
                             return need_writable(gpio::find_count(counters.root, axis) +
                                                  "/function");
                           }));
  }
}

void examine_converters(const gpio::ConverterSettings& converters, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < converters.axes.size(); ++i) {
    const gpio::ConverterAxis& axis = converters.axes[i];
    findings.push_back(row(fmt::format("motor {}", i),
                           fmt::format("{} output {}", axis.device, axis.channel),
                           [&converters, &axis] {
                             return need_writable(gpio::find_converter(converters.root, axis));
                           }));
  }
}

void examine_pwm(const gpio::MotorSettings& motors, std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < motors.axes.size(); ++i) {
    const gpio::MotorLines& axis = motors.axes[i];
    findings.push_back(row(fmt::format("motor {}", i),
                           fmt::format("{} channel {}", axis.chip, axis.channel), [&motors, &axis] {
                             return need_writable(
                                 gpio::find_pwm_chip(motors.pwm_root, axis.chip, axis.channel) +
                                 "/export");
                           }));
  }
}

void examine_model(const ControllerFile& file, std::vector<Finding>& findings) {
  findings.push_back(row("model", file.model.filename().string(), [&file] {
    const support::BlobFile model(file.model);
    core::Controller controller;
    (void)controller.configure(file.configuration);  // was checked when the file was read
    const core::ModelStatus status = controller.load_model(model.view());
    if (status != core::ModelStatus::kOk) {
      throw support::UserError(fmt::format("{}: {} (build it for this rate and device)",
                                           file.model.string(), core::describe(status)));
    }
    return fmt::format("{} bytes, {} points", model.bytes().size(),
                       model.view().header().point_count);
  }));
}

void examine_real_time(const RealTimeSettings& settings, std::vector<Finding>& findings) {
  const std::vector<std::string> missing = missing_rights(settings);
  const std::string which = fmt::format("SCHED_FIFO {}, locked memory", settings.priority);
  for (const std::string& sentence : missing) {
    findings.push_back({"real time", which, false, settings.required, sentence});
  }
  if (missing.empty()) {
    findings.push_back({"real time", which, true, true, "permitted"});
  }
  const bool preempt = access("/sys/kernel/realtime", F_OK) == 0;
  findings.push_back({"kernel", "PREEMPT_RT", preempt, false,
                      preempt ? "yes"
                              : "no: ticks may be later than with PREEMPT_RT (docs/LINUX-BOARD.md "
                                "tells how to measure this)"});
}

void examine_link(const LinkSettings& link, std::vector<Finding>& findings) {
  if (link.socket.empty()) {
    findings.push_back(row("USB device port", link.usb_port, [&link] {
      const std::string port = hal::linux_usb::find_udc(link.usb_port);
      (void)need_writable("/sys/kernel/config");
      return port;
    }));
    return;
  }
  const std::string& socket = link.socket;
  findings.push_back(row("socket", socket, [&socket] {
    const std::filesystem::path folder = std::filesystem::path(socket).parent_path();
    return need_writable(folder.empty() ? "." : folder.string());
  }));
}

void examine_watchdog(const std::string& device, std::vector<Finding>& findings) {
  if (!device.empty()) {
    findings.push_back(row("watchdog", device, [&device] { return need_writable(device); }));
  }
}

const char* verdict(const Finding& finding) {
  if (finding.good) {
    return "good";
  }
  return finding.matters ? "WRONG" : "warning";
}

std::string describe(const support::Device& device) {
  const std::string used = support::defaults_text(device);
  return used.empty() ? device.about : fmt::format("{}; defaults: {}", device.about, used);
}

}  // namespace

std::vector<Finding> examine(const ControllerFile& file) {
  std::vector<Finding> findings;
  findings.push_back({"configuration", file.file, true, true, "limits are valid"});
  findings.push_back({"device", file.device.name, true, true, describe(file.device)});
  examine_model(file, findings);
  examine_names(file.board, findings);
  examine_lines(file.board, findings);
  examine_banks(file.board, findings);
  examine_counters(file.board.counters, findings);
  examine_pwm(file.board.motors, findings);
  examine_converters(file.board.converters, findings);
  examine_watchdog(file.board.watchdog, findings);
  examine_link(file.link, findings);
  examine_real_time(file.real_time, findings);
  return findings;
}

int print_findings(const std::vector<Finding>& findings) {
  std::size_t what = 0;
  std::size_t which = 0;
  for (const Finding& finding : findings) {
    what = std::max(what, finding.what.size());
    which = std::max(which, finding.which.size());
  }
  std::size_t wrong = 0;
  for (const Finding& finding : findings) {
    fmt::print("{:<{}}  {:<{}}  {:<7}  {}\n", finding.what, what, finding.which, which,
               verdict(finding), finding.detail);
    wrong += !finding.good && finding.matters ? 1U : 0U;
  }
  fmt::print("{}\n", wrong == 0 ? "the controller would run"
                                : fmt::format("{} wrong: the controller would not run", wrong));
  return wrong == 0 ? kExitOk : kExitFailed;
}

}  // namespace tactree::controller
