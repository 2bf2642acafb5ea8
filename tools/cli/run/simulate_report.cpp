#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "run/simulate_run.hpp"
#include "tactree/simulation/trace.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {
namespace {

// Number of functions listed in the summary of instructions.
constexpr std::size_t kReportedFunctions = 10;

void write_trace(const SimulateOptions& options, const std::vector<simulation::Sample>& samples) {
  std::string csv = simulation::trace_heading(options.panel);
  for (const simulation::Sample& sample : samples) {
    simulation::append_trace(csv, sample, options.panel);
  }
  support::write_file(options.trace, csv);
}

nlohmann::json instructions_json(const Outcome& outcome) {
  const std::optional<emulation::InstructionCounts>& counts = outcome.instructions;
  if (!counts) {
    return {{"max", nullptr}, {"mean", nullptr}, {"bound", nullptr}};
  }
  nlohmann::json functions = nlohmann::json::array();
  for (const emulation::FunctionCount& f : counts->functions) {
    const double mean = static_cast<double>(f.total) / static_cast<double>(counts->ticks);
    functions.push_back({{"name", f.name}, {"max", f.max}, {"mean", mean}});
  }
  const auto bound =
      outcome.bound ? nlohmann::json(outcome.bound->instructions) : nlohmann::json(nullptr);
  return {{"max", counts->max},     {"mean", counts->mean()},       {"bound", bound},
          {"start", counts->start}, {"checksum", counts->checksum}, {"functions", functions}};
}

nlohmann::json to_json(const std::vector<std::string>& injections, const Harm& harm) {
  return {{"faults", injections},
          {"from_s", harm.from_s},
          {"detected_s", harm.detected_s ? nlohmann::json(*harm.detected_s) : nlohmann::json()},
          {"force_max_N", harm.force_max_N},
          {"moved_m", harm.moved_m}};
}

nlohmann::json to_json(const setup::SceneFile& scene, const simulation::Summary& s) {
  nlohmann::json bodies = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.names.size(); ++i) {
    bodies.push_back({{"blob", scene.names[i]},
                      {"contact_ticks", s.bodies[i].contact_ticks},
                      {"force_max_N", s.bodies[i].force_max_N},
                      {"torque_max_Nm", s.bodies[i].torque_max_Nm}});
  }
  return bodies;
}

nlohmann::json to_json(const std::vector<PanelEvent>& events) {
  nlohmann::json list = nlohmann::json::array();
  for (const PanelEvent& event : events) {
    list.push_back(
        {{"t_s", event.t_s}, {"state", core::name_of(event.state)}, {"homed", event.homed}});
  }
  return list;
}

nlohmann::json to_json(const SimulateOptions& options, const setup::SceneFile& scene,
                       const Outcome& outcome) {
  const simulation::Summary& s = outcome.summary;
  nlohmann::json json = setup::summary_json(s);
  json.update(
      {{"board", options.board},
       {"device", options.device},
       {"mode", options.mode},
       {"rate_hz", options.setup.controller.rate_hz},
       {"bodies", to_json(scene, s)},
       {"injected", outcome.harm ? to_json(options.injections, *outcome.harm) : nlohmann::json()},
       {"instructions", instructions_json(outcome)}});
  if (options.panel) {
    json["panel"] = to_json(outcome.panel);
  }
  return json;
}

void print_instructions(const emulation::InstructionCounts& counts,
                        const std::optional<TickBound>& bound) {
  fmt::print(
      "instructions       {:.0f} per tick on average, {} at most{}, {} before the first tick\n",
      counts.mean(), counts.max, bound ? fmt::format(" (bound {})", bound->instructions) : "",
      counts.start);
  if (bound && bound->work_is_reduced) {
    fmt::print(
        "work               reduced, to meet each deadline: the surface may follow with a delay\n");
  }
  for (std::size_t i = 0; i < std::min(kReportedFunctions, counts.functions.size()); ++i) {
    const emulation::FunctionCount& f = counts.functions[i];
    fmt::print("  {:8.0f} {:8}  {}\n",
               static_cast<double>(f.total) / static_cast<double>(counts.ticks), f.max, f.name);
  }
}

void print_bodies(const setup::SceneFile& scene, const simulation::Summary& s) {
  for (std::size_t i = 0; i < scene.names.size(); ++i) {
    const simulation::BodySummary& body = s.bodies[i];
    fmt::print("body {:<14}{}: in contact {}, largest force {:.4f} N, torque {:.4g} Nm\n", i,
               scene.names[i], body.contact_ticks, body.force_max_N, body.torque_max_Nm);
  }
  if (s.crowded_ticks > 0) {
    fmt::print("crowded            {} ticks: more than {} bodies within reach, some not rendered\n",
               s.crowded_ticks, core::kMaxReachableBodies);
  }
}

void print_panel(const std::vector<PanelEvent>& events) {
  const char* title = "panel";
  for (const PanelEvent& event : events) {
    fmt::print("{:<18} {:.3f} s: {}{}\n", title, event.t_s, core::name_of(event.state),
               event.homed ? "" : ", not homed");
    title = "";
  }
}

void print_harm(const SimulateOptions& options, const Harm& harm) {
  fmt::print("injected           {}\n", fmt::join(options.injections, ", "));
  if (harm.detected_s) {
    fmt::print("detected           after {:.1f} ms\n", 1e3 * *harm.detected_s);
  } else {
    fmt::print("detected           no fault was latched\n");
  }
  fmt::print("largest force      {:.4f} N after it\n", harm.force_max_N);
  fmt::print("tip displaced      by up to {:.2f} mm from its path without faults\n",
             1e3 * harm.moved_m);
}

/// Distribution of the tick lengths of an emulated board.
simulation::Histogram histogram(const Outcome& outcome) {
  simulation::Histogram h;
  if (outcome.instructions) {
    h.label = "instructions per tick";
    h.bar_width = static_cast<double>(emulation::kBucketInstructions);
    for (const emulation::InstructionBucket& bucket : outcome.instructions->buckets) {
      h.bars.push_back({static_cast<double>(bucket.fewest), static_cast<double>(bucket.ticks)});
    }
  }
  return h;
}

void write_plot(const SimulateOptions& options, const setup::SceneFile& scene,
                const Outcome& outcome) {
  const double rate_hz = static_cast<double>(options.setup.controller.rate_hz);
  if (!options.compare) {
    const std::string title = fmt::format("{}: {}, {} mode, {:.6g} Hz", options.blob,
                                          options.device, options.mode, rate_hz);
    support::write_file(options.plot,
                        simulation::plot_svg(outcome.samples, title, histogram(outcome)));
    return;
  }
  SimulateOptions other = options;
  other.mode = options.mode == "paper" ? "surface" : "paper";
  other.record.clear();
  const Outcome beside = run(other, scene);
  const bool paper_first = options.mode == "paper";
  const std::string title =
      fmt::format("{}: {}, both modes, {:.6g} Hz", options.blob, options.device, rate_hz);
  support::write_file(options.plot, simulation::plot_modes_svg(
                                        paper_first ? beside.samples : outcome.samples,
                                        paper_first ? outcome.samples : beside.samples, title));
}

}  // namespace

void write_results(const SimulateOptions& options, const setup::SceneFile& scene,
                   const Outcome& outcome) {
  if (!options.trace.empty()) {
    write_trace(options, outcome.samples);
  }
  if (!options.plot.empty()) {
    write_plot(options, scene, outcome);
  }
  if (!options.json.empty()) {
    support::write_file(options.json, support::json_text(to_json(options, scene, outcome)));
  }
}

void print_summary(const SimulateOptions& options, const setup::SceneFile& scene,
                   const Outcome& outcome) {
  const simulation::Summary& s = outcome.summary;
  fmt::print("board {}, device {}, mode {}, {:.6g} Hz\n", options.board, options.device,
             options.mode, options.setup.controller.rate_hz);
  fmt::print("ticks              {}\n", s.ticks);
  fmt::print("in contact         {} ({:.1f} %)\n", s.contact_ticks,
             100.0 * static_cast<double>(s.contact_ticks) / static_cast<double>(s.ticks));
  fmt::print("largest force      {:.4f} N\n", s.force_max_N);
  fmt::print("largest step       {:.4f} N per tick\n", s.force_step_max_N);
  fmt::print("deepest contact    {:.4f} mm\n", 1e3 * s.penetration_max_m);
  fmt::print("overruns           {}\n", s.overruns);
  fmt::print("trace checksum     {:08x}\n", s.trace_crc32);
  if (is_scene(options)) {
    print_bodies(scene, s);
  }
  for (const simulation::FaultEvent& event : s.faults) {
    fmt::print("fault {:2} {} at tick {}\n", static_cast<int>(event.fault),
               core::name_of(event.fault), event.tick);
  }
  print_panel(outcome.panel);
  if (outcome.harm) {
    print_harm(options, *outcome.harm);
  }
  if (outcome.instructions) {
    print_instructions(*outcome.instructions, outcome.bound);
  }
}

}  // namespace tactree::cli
