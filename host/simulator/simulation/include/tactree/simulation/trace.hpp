#pragma once
// Results of a simulation as a CSV table and as SVG plots.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

enum class TraceType : std::uint8_t { kFloat64, kFloat32, kFlag, kState, kUint32, kInt32 };

struct TraceColumn {
  std::string name;  ///< with the unit
  TraceType type = TraceType::kFloat32;
};

/// The columns of a trace.
[[nodiscard]] const std::vector<TraceColumn>& trace_columns();

/// Writes the values of a sample, in the order of trace_columns(). A double holds each of them
/// exactly; that of a state is its number.
void trace_values(const Sample& sample, std::vector<double>& values);

/// First row of a trace: the names of its columns with units. With the panel of the board, `button`
/// and `lamp` follow.
[[nodiscard]] std::string trace_heading(bool with_panel = false);

/// Appends the row of a sample. A float32 that is read back is bit-identical.
void append_trace(std::string& csv, const Sample& sample, bool with_panel = false);

/// Distribution of a value over the ticks, with its proven upper bound `bound`, 0 if unknown.
struct Histogram {
  struct Bar {
    double from = 0.0;
    double count = 0.0;
  };
  std::string label;
  double bar_width = 1.0;
  std::vector<Bar> bars;  ///< ascending
  double bound = 0.0;
};

/// SVG page with the components and magnitude of the force and the penetration over time, `title`
/// above and the histogram below if it has bars. Long runs are drawn as the band between the
/// minimum and the maximum of each pixel column, which preserves every spike.
[[nodiscard]] std::string plot_svg(std::span<const Sample> samples, const std::string& title,
                                   const Histogram& histogram = {});

/// SVG page with the force of two runs along the same path, one per mode: the whole run, and a
/// quarter of a second after half the run.
[[nodiscard]] std::string plot_modes_svg(std::span<const Sample> surface,
                                         std::span<const Sample> paper, const std::string& title);

}  // namespace tactree::simulation
