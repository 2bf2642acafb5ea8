#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "svg.hpp"
#include "tactree/evaluation/evaluation.hpp"
#include "tactree/simulation/stability.hpp"

namespace tactree::evaluation {
namespace {

constexpr double kPictureWidth = 900.0;
constexpr double kPictureHeight = 480.0;
constexpr double kPlotLeft = 90.0;
constexpr double kPlotRight = 740.0;
constexpr double kPlotTop = 50.0;
constexpr double kPlotBottom = 420.0;
constexpr double kMaxDamping_Ns_m = 4.0;
constexpr double kSoftest_N_m = 100.0;
constexpr double kStiffest_N_m = 100000.0;

struct Rate {
  double hz;
  const char* colour;
};
constexpr Rate kRates[] = {
    {1000.0, "#0072b2"}, {2000.0, "#009e73"}, {4000.0, "#d55e00"}, {10000.0, "#cc79a7"}};

double x_of(double damping_Ns_m) {
  return kPlotLeft + damping_Ns_m / kMaxDamping_Ns_m * (kPlotRight - kPlotLeft);
}

double y_of(double stiffness_N_m) {
  const double share =
      std::log(std::clamp(stiffness_N_m, kSoftest_N_m, kStiffest_N_m) / kSoftest_N_m) /
      std::log(kStiffest_N_m / kSoftest_N_m);
  return kPlotBottom - share * (kPlotBottom - kPlotTop);
}

void grid(std::string& svg) {
  const auto line = [&svg](double x1, double y1, double x2, double y2) {
    fmt::format_to(std::back_inserter(svg),
                   "<path d=\"M{:.1f} {:.1f} L{:.1f} {:.1f}\" stroke=\"#e4e4e4\"/>\n", x1, y1, x2,
                   y2);
  };
  for (double stiffness = kSoftest_N_m; stiffness <= 1.001 * kStiffest_N_m; stiffness *= 10.0) {
    line(kPlotLeft, y_of(stiffness), kPlotRight, y_of(stiffness));
    add_text(svg, kPlotLeft - 8.0, y_of(stiffness) + 4.0, "end", fmt::format("{:g}", stiffness));
  }
  for (double damping = 0.0; damping <= kMaxDamping_Ns_m; damping += 0.5) {
    line(x_of(damping), kPlotTop, x_of(damping), kPlotBottom);
    add_text(svg, x_of(damping), kPlotBottom + 20.0, "middle", fmt::format("{:g}", damping));
  }
  add_text(svg, 0.5 * (kPlotLeft + kPlotRight), kPlotBottom + 44.0, "middle",
           "damping of the wall / (Ns/m)");
  add_text(svg, kPlotLeft - 60.0, kPlotTop - 18.0, "start", "largest stable stiffness / (N/m)");
}

void curve(std::string& svg, const Rate& rate) {
  std::string measured;
  std::string predicted;
  for (double damping = 0.0; damping <= kMaxDamping_Ns_m; damping += 0.5) {
    simulation::StabilityCase wall;
    wall.rate_hz = rate.hz;
    wall.wall_damping_Ns_m = damping;
    const double x = x_of(damping);
    measured += fmt::format("{:.1f},{:.1f} ", x, y_of(simulation::largest_stable_stiffness(wall)));
    predicted += fmt::format("{:.1f},{:.1f} ", x, y_of(simulation::predicted_stiffness(wall)));
  }
  fmt::format_to(
      std::back_inserter(svg),
      "<polyline fill=\"none\" stroke=\"{0}\" stroke-width=\"2\" points=\"{1}\"/>\n"
      "<polyline fill=\"none\" stroke=\"{0}\" stroke-dasharray=\"5 4\" points=\"{2}\"/>\n",
      rate.colour, measured, predicted);
}

void legend(std::string& svg, const std::vector<Rate>& rates) {
  double y = kPlotTop + 20.0;
  for (const Rate& rate : rates) {
    fmt::format_to(std::back_inserter(svg),
                   "<path d=\"M{0:.1f} {1:.1f} h24\" stroke=\"{2}\" stroke-width=\"2\"/>\n",
                   kPlotRight + 14.0, y - 4.0, rate.colour);
    add_text(svg, kPlotRight + 44.0, y, "start", fmt::format("{:g} kHz", 1e-3 * rate.hz));
    y += 22.0;
  }
  add_text(svg, kPlotRight + 14.0, y + 6.0, "start", "lines: simulated");
  add_text(svg, kPlotRight + 14.0, y + 26.0, "start", "dashes: predicted");
}

}  // namespace

std::string z_width_svg(bool quick) {
  const std::vector<Rate> rates(std::begin(kRates), quick ? kRates + 2 : std::end(kRates));
  std::string svg = begin_svg(kPictureWidth, kPictureHeight);
  grid(svg);
  for (const Rate& rate : rates) {
    curve(svg, rate);
  }
  legend(svg, rates);
  return svg + kSvgEnd;
}

}  // namespace tactree::evaluation
