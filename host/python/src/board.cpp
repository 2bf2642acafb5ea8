// tactree.Board: a connected board.

#include "tactree/client/board.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "array_table.hpp"
#include "bindings.hpp"
#include "model.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/client/start_report.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_table.hpp"

namespace tactree::python {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

// Interval of the checks for Ctrl-C while waiting.
constexpr milliseconds kInterval{20};
// Of close(), for a running call; longer than the board's time for a reply.
constexpr milliseconds kPatience{2000};

template <std::size_t N>
std::string text_of(const char (&text)[N]) {
  return {text, std::find(text, text + N, '\0')};
}

milliseconds milliseconds_of(double seconds, const char* name) {
  if (!(seconds >= 0.0 && seconds <= 1e6)) {
    support::refuse(name, fmt::format("{:.6g} s are out of range", seconds), "give 0 .. 1e6");
  }
  return milliseconds(std::llround(1e3 * seconds));
}

/// All calls that wait release the interpreter's lock. One call at a time, except post_stop(),
/// is_open(), close(), and subscribe() during take().
class NativeBoard {
 public:
  NativeBoard(const std::string& port, unsigned baud, std::uint16_t link_timeout_ms,
              std::size_t stream_capacity)
      : board_(std::make_shared<client::Board>(
            port, client::BoardOptions{baud, link_timeout_ms, stream_capacity})) {}

  /// A call holds the board until it returns, so that close() in another thread does not free it.
  [[nodiscard]] std::shared_ptr<client::Board> board() const {
    auto held = held_board();
    if (!held) {
      throw client::LinkError("the board is closed (open it again)");
    }
    return held;
  }

  /// Ends the session. A call that waits ends promptly; one that writes, such as flash(), keeps the
  /// session until it returns.
  void close() {
    std::shared_ptr<client::Board> last;
    {
      const std::lock_guard lock(mutex_);
      last.swap(board_);
    }
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (last.use_count() > 1 && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(milliseconds(1));
    }
  }
  [[nodiscard]] bool is_open() const {
    const auto held = held_board();
    return held && held->in_session();
  }

  void arm(double patience_s) {
    const auto held = board();
    client::Board& b = *held;
    const auto deadline = b.connection().now() + milliseconds_of(patience_s, "patience_s");
    b.begin_arming();
    try {
      while (!b.go_on_arming()) {
        if (b.connection().now() > deadline) {
          throw client::LinkError(b.connection().name() + ": arm: not confirmed (" +
                                  b.who_confirms() + ")");
        }
        check_signals();
        require_open();
        b.connection().sleep(kInterval);
      }
    } catch (...) {
      b.post_stop();
      throw;
    }
  }

  void wait(double seconds) const {
    const auto held = board();
    const client::Connection& connection = held->connection();
    const auto end = connection.now() + milliseconds_of(seconds, "seconds");
    while (connection.now() < end && connection.connected()) {
      check_signals();
      require_open();
      connection.sleep(std::min<std::chrono::microseconds>(kInterval, end - connection.now()));
    }
  }

  /// Returns the number of the subscription, for take(). Ends the preceding one.
  std::uint64_t subscribe(std::uint32_t every_ticks) {
    const auto held = board();
    {
      const std::lock_guard lock(mutex_);
      ++subscription_;
    }
    held->subscribe({telemetry::kRecordedFields, every_ticks});
    const std::lock_guard lock(mutex_);
    (void)held->take_stream();
    sequence_ = telemetry::TickSequence(std::max(every_ticks, 1U));
    return subscription_;
  }

  /// Waits until there are rows, for at most `seconds` of the board's time. Empty: there were none.
  /// Throws LinkError once the subscription has ended, or the board has ended the session and all
  /// rows have been taken.
  void take(std::uint64_t subscription, double seconds, ArrayTable& table) {
    const auto held = board();
    client::Board& b = *held;
    const client::Connection& connection = b.connection();
    const auto end = connection.now() + milliseconds_of(seconds, "seconds");
    while (true) {
      // Sampled before the rows are taken, so the last pass takes all that was received.
      const bool lost = !b.in_session();
      append_stream(b, subscription, table);
      if (table.rows() > 0) {
        return;
      }
      require_open();
      if (lost) {
        throw client::LinkError(connection.name() + ": telemetry: " +
                                (b.connected() ? "the board ended the session: it was reset, or "
                                                 "another program opened one"
                                               : "the board is disconnected"));
      }
      if (connection.now() >= end) {
        return;
      }
      check_signals();
      connection.sleep(milliseconds(1));
    }
  }

 private:
  [[nodiscard]] std::shared_ptr<client::Board> held_board() const {
    const std::lock_guard lock(mutex_);
    return board_;
  }
  void require_open() const { (void)board(); }

  void append_stream(client::Board& board, std::uint64_t subscription, ArrayTable& table) {
    const std::lock_guard lock(mutex_);
    if (subscription != subscription_) {
      throw client::LinkError(
          board.connection().name() +
          ": telemetry: the subscription has ended (board.telemetry() begins one)");
    }
    for (const client::Telemetry& message : board.take_stream()) {
      if (const auto tick = sequence_.next(message)) {
        telemetry::values_of(*tick, values_);
        table.append(values_);
      }
    }
  }

  mutable std::mutex mutex_;  // guards all below
  std::shared_ptr<client::Board> board_;
  std::uint64_t subscription_ = 0;
  telemetry::TickSequence sequence_;
  std::vector<double> values_;
};

json identity(const core::wire::IdentifyReply& r) {
  return {{"board", text_of(r.board)},
          {"firmware", text_of(r.firmware)},
          {"protocol", fmt::format("{}.{}", r.version_major, r.version_minor)},
          {"serial", fmt::format("{:08x}{:08x}{:08x}", r.serial[0], r.serial[1], r.serial[2])}};
}

json capabilities(const core::wire::CapabilitiesReply& r) {
  const auto has = [&](core::wire::BoardFlag flag) { return has_flag(r, flag); };
  using enum core::wire::BoardFlag;
  return {{"rate_hz", r.rate_hz},
          {"force_max_N", r.force_max_N},
          {"force_limit_N", r.force_limit_N},
          {"slew_N_s", r.slew_N_s},
          {"slew_limit_N_s", r.slew_limit_N_s},
          {"host_force_max_N", r.host_force_max_N},
          {"stiffness_N_m", r.stiffness_N_m},
          {"stiffness_limit_N_m", r.stiffness_limit_N_m},
          {"bodies_max", r.bodies_max},
          {"slots", r.slots},
          {"slot_bytes", r.slot_bytes},
          {"trace_ticks", r.trace_ticks},
          {"cycles_per_tick", r.cycles_per_tick},
          {"signature_required", has(kSignatureRequired)},
          {"dead_man_required", has(kDeadManRequired)},
          {"link_required", has(kLinkRequired)},
          {"homed", has(kHomed)},
          {"work_is_reduced", has(kWorkReduced)},
          {"watch_only", has(kWatchOnly)},
          {"shared", has(kShared)}};
}

json status(const core::wire::StateReply& r) {
  return {{"tick", r.tick},
          {"state", core::name_of(static_cast<core::State>(
                        std::min<std::uint32_t>(r.state, core::kStates - 1U)))},
          {"faults", r.faults},
          {"fault_names", client::names_of(r.faults)},
          {"limits", r.limits},
          {"overruns", r.overruns},
          {"board_time_us", r.board_time_us},
          {"probe_m", r.probe_m},
          {"force_N", r.force_N}};
}

json first_fault(const core::wire::ReadFaultReply& r) {
  if (r.faults == 0U) {
    return nullptr;
  }
  return {{"faults", r.faults},   {"fault_names", client::names_of(r.faults)},
          {"tick", r.tick},       {"probe_m", r.probe_m},
          {"proxy_m", r.proxy_m}, {"velocity_m_s", r.velocity_m_s},
          {"force_N", r.force_N}};
}

json parameters(const std::vector<core::wire::ParameterReply>& list) {
  json all = json::object();
  for (const core::wire::ParameterReply& p : list) {
    all[text_of(p.name)] = {{"value", p.value}, {"min", p.min}, {"max", p.max}};
  }
  return all;
}

/// A method that waits and returns a dictionary.
template <class Get>
void add_getter(py::class_<NativeBoard>& board, const char* name, Get get, const char* about) {
  board.def(
      name,
      [get](NativeBoard& b) {
        json reply;
        {
          const py::gil_scoped_release unlocked;
          reply = get(*b.board());
        }
        return to_python(reply);
      },
      about);
}

/// A method that waits.
template <class Do>
void add_request(py::class_<NativeBoard>& board, const char* name, Do request, const char* about) {
  board.def(
      name,
      [request](NativeBoard& b) {
        const py::gil_scoped_release unlocked;
        request(*b.board());
      },
      about);
}

void flash(NativeBoard& board, const Model& model, const py::object& progress) {
  client::ModelFile file;
  file.bytes = model.bytes();
  const py::gil_scoped_release unlocked;
  board.board()->flash(file, [&](std::size_t done, std::size_t all) {
    check_signals();
    const py::gil_scoped_acquire lock;
    if (!progress.is_none()) {
      progress(static_cast<double>(done) / static_cast<double>(all));
    }
  });
}

void add_replies(py::class_<NativeBoard>& board) {
  add_getter(
      board, "identify", [](client::Board& b) { return identity(b.identify()); },
      "Name, firmware, serial number.");
  add_getter(
      board, "capabilities", [](client::Board& b) { return capabilities(b.capabilities()); },
      "Features and limits.");
  add_getter(
      board, "status", [](client::Board& b) { return status(b.state()); },
      "State, faults, position, force.");
  add_getter(
      board, "first_fault", [](client::Board& b) { return first_fault(b.first_fault()); },
      "Conditions of the first fault; None without one.");
  add_getter(
      board, "parameters", [](client::Board& b) { return parameters(b.parameters()); },
      "The calibration: name to value and range.");
}

void add_requests(py::class_<NativeBoard>& board) {
  add_request(
      board, "stop", [](client::Board& b) { b.stop(); }, "Stops, and waits for the reply.");
  add_request(
      board, "clear_faults", [](client::Board& b) { b.clear_faults(); }, "Clears the faults.");
  add_request(
      board, "home", [](client::Board& b) { b.home(); }, "The device is in its home pose.");
  add_request(
      board, "roll_back", [](client::Board& b) { b.roll_back(); }, "Activates the previous model.");
  add_request(
      board, "save_parameters", [](client::Board& b) { b.save_parameters(); },
      "Stores the calibration.");
  add_request(
      board, "reconnect", [](client::Board& b) { b.reconnect(); },
      "Opens the port and a session again.");
  board.def(
      "set_parameter",
      [](NativeBoard& b, const std::string& name, float value) {
        const py::gil_scoped_release unlocked;
        b.board()->set_parameter(name, value);
      },
      py::arg("name"), py::arg("value"), "Sets a value of the calibration.");
  board.def(
      "set_limits",
      [](NativeBoard& b, float force_max_N, float slew_N_s, float ramp_s) {
        const py::gil_scoped_release unlocked;
        b.board()->set_limits(force_max_N, slew_N_s, ramp_s);
      },
      py::arg("force_max_N"), py::arg("slew_N_s"), py::arg("ramp_s"), "Sets the force limits.");
  board.def(
      "set_material",
      [](NativeBoard& b, float stiffness, float damping, float static_friction,
         float dynamic_friction, bool use_materials) {
        const py::gil_scoped_release unlocked;
        b.board()->set_material(
            {stiffness, damping, static_friction, dynamic_friction, use_materials ? 1U : 0U});
      },
      py::arg("stiffness_N_m"), py::arg("damping_Ns_m"), py::arg("static_friction"),
      py::arg("dynamic_friction"), py::arg("use_materials"), "Sets the contact parameters.");
  board.def(
      "set_texture",
      [](NativeBoard& b, float height, float wavelength) {
        const py::gil_scoped_release unlocked;
        b.board()->set_texture({height, wavelength});
      },
      py::arg("height_m"), py::arg("wavelength_m"), "Sets the bumps of the surface.");
  board.def("flash", flash, py::arg("model"), py::arg("progress") = py::none(),
            "Writes and activates a model.");
}

py::array take(NativeBoard& board, std::uint64_t subscription, double seconds) {
  ArrayTable table(tick_fields());
  {
    const py::gil_scoped_release unlocked;
    board.take(subscription, seconds, table);
  }
  return std::move(table).to_array();
}

}  // namespace

void add_board(py::module_& module) {
  py::class_<NativeBoard> board(module, "NativeBoard");
  board.def(py::init([](const std::string& port, unsigned baud, std::uint16_t link_timeout_ms,
                        std::size_t stream_capacity) {
              const py::gil_scoped_release unlocked;
              return std::make_unique<NativeBoard>(port, baud, link_timeout_ms, stream_capacity);
            }),
            py::arg("port"), py::arg("baud"), py::arg("link_timeout_ms"),
            py::arg("stream_capacity"));
  add_replies(board);
  add_requests(board);
  board.def("arm", &NativeBoard::arm, py::arg("patience_s"),
            py::call_guard<py::gil_scoped_release>(), "Arms, and waits until active.");
  board.def("wait", &NativeBoard::wait, py::arg("seconds"),
            py::call_guard<py::gil_scoped_release>(), "Lets the board's time pass.");
  board.def("close", &NativeBoard::close, py::call_guard<py::gil_scoped_release>(),
            "Closes the session.");
  board.def(
      "post_stop", [](NativeBoard& b) { b.board()->post_stop(); }, "Stops, without waiting.");
  board.def("subscribe", &NativeBoard::subscribe, py::arg("every_ticks"),
            py::call_guard<py::gil_scoped_release>(), "Begins or ends telemetry.");
  board.def("take", take, py::arg("subscription"), py::arg("seconds"),
            "The rows since the last call.");
  board.def(
      "dropped", [](NativeBoard& b) { return b.board()->dropped(); }, "Dropped messages.");
  board.def(
      "name", [](NativeBoard& b) { return b.board()->connection().name(); }, "The port.");
  board.def_property_readonly("is_open", &NativeBoard::is_open,
                              "False once the session has ended.");
  module.def("ports", client::list_ports, "Ports that may have a board.");
  module.attr("USUAL_BAUD") = client::kUsualBaud;
}

}  // namespace tactree::python
