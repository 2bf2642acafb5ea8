#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

struct TraceOptions {
  BoardPort port;
  std::string output;
};

std::string row(const client::TracedTick& traced) {
  const core::FlightRecord& r = traced.record;
  const auto scaled = [](int units, float per_unit) {
    return static_cast<double>(units) / static_cast<double>(per_unit);
  };
  return fmt::format(
      "{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},"
      "{:.4g}\n",
      traced.tick, core::name_of(r.state_of()), r.in_contact() ? 1 : 0, r.slipping() ? 1 : 0,
      scaled(r.probe[0], core::FlightRecord::kMetre),
      scaled(r.probe[1], core::FlightRecord::kMetre),
      scaled(r.probe[2], core::FlightRecord::kMetre),
      scaled(r.force[0], core::FlightRecord::kNewton),
      scaled(r.force[1], core::FlightRecord::kNewton),
      scaled(r.force[2], core::FlightRecord::kNewton),
      scaled(r.proxy[0], core::FlightRecord::kDepth),
      scaled(r.proxy[1], core::FlightRecord::kDepth),
      scaled(r.proxy[2], core::FlightRecord::kDepth), scaled(r.load, 128.0F));
}

void print_first_fault(const core::wire::ReadFaultReply& fault) {
  if (fault.faults == 0U) {
    fmt::print(stderr, "no fault since the last clear\n");
    return;
  }
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    if (core::has_fault(fault.faults, static_cast<core::Fault>(code))) {
      fmt::print(stderr, "fault {:2} {} at tick {}\n", code,
                 core::name_of(static_cast<core::Fault>(code)), fault.tick);
    }
  }
}

void trace(const TraceOptions& options) {
  support::check_outputs({options.output});
  const auto board = connect(options.port);
  print_first_fault(board->first_fault());
  std::string csv =
      "tick,state,contact,slipping,x_m,y_m,z_m,force_x_N,force_y_N,force_z_N,to_proxy_x_m,"
      "to_proxy_y_m,to_proxy_z_m,load\n";
  for (const client::TracedTick& tick : board->trace()) {
    csv += row(tick);
  }
  if (options.output.empty()) {
    fmt::print("{}", csv);
  } else {
    support::write_file(options.output, csv);
  }
}

}  // namespace

void add_trace_command(CLI::App& app, int&) {
  auto options = std::make_shared<TraceOptions>();
  CLI::App* verb =
      app.add_subcommand("trace", "Reads the last ticks from a board's flight recorder, as CSV");
  add_port_options(*verb, options->port);
  verb->add_option("-o,--output", options->output, "CSV file (default: standard output)");
  verb->callback([options] { trace(*options); });
}

}  // namespace tactree::cli
