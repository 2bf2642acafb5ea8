#pragma once
// What a simulation did, as a table for programs and as a picture for people.

#include <span>
#include <string>
#include <vector>

#include "tactree/simulation/simulation.hpp"

namespace tactree::simulation {

/// The first row of a trace: the names of its columns, units in the names.
[[nodiscard]] std::string trace_heading();

/// One row per sample. Every float32 is written so that reading it gives the same bits.
void append_trace(std::string& csv, const Sample& sample);

/// How often a figure of the ticks was where. `bound`: what it is proven never to exceed; 0: not
/// known.
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

/// An SVG page: the force's components and size, and the penetration, over time. `title` is told
/// above. Long runs are drawn as the band between the lowest and the highest value of each column
/// of pixels, so that no spike is lost.
/// Where the histogram has bars it is below.
[[nodiscard]] std::string plot_svg(std::span<const Sample> samples, const std::string& title,
                                   const Histogram& histogram = {});

/// An SVG page with the force of two runs along the same path, one in each mode: all of it, and a
/// quarter of a second from the middle.
[[nodiscard]] std::string plot_modes_svg(std::span<const Sample> surface,
                                         std::span<const Sample> paper, const std::string& title);

}  // namespace tactree::simulation
