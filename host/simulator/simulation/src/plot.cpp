#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <vector>

#include "tactree/simulation/trace.hpp"

namespace tactree::simulation {
namespace {

constexpr double kWidth = 1000.0;
constexpr double kHeight = 640.0;
constexpr double kLeft = 80.0;
constexpr double kRight = 980.0;

struct Curve {
  const char* name;
  const char* colour;
  double width;
  std::span<const Sample> samples;
  std::function<double(const Sample&)> value;
};

/// A coordinate system on the page.
struct Panel {
  double top;
  double bottom;
  double t_min;
  double t_max;
  double low;
  double high;
  const char* label;

  [[nodiscard]] double x(double t) const {
    return kLeft + (t - t_min) / (t_max - t_min) * (kRight - kLeft);
  }
  [[nodiscard]] double y(double value) const {
    return bottom - (value - low) / (high - low) * (bottom - top);
  }
};

/// Step of an axis: 1, 2 or 5 times a power of ten, such that `range` has at most `count` steps.
double tick_step(double range, double count) {
  const double rough = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

void text(std::string& svg, double x, double y, const char* anchor, const std::string& words,
          const char* extra = "") {
  fmt::format_to(std::back_inserter(svg),
                 "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor,
                 extra, words);
}

void line(std::string& svg, double x1, double y1, double x2, double y2, const char* colour) {
  fmt::format_to(std::back_inserter(svg),
                 "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n",
                 x1, y1, x2, y2, colour);
}

std::string escaped(const std::string& words) {
  std::string safe;
  for (const char c : words) {
    safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return safe;
}

/// Number at an axis with as many decimals as its step has.
std::string number(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < 0.5 * step ? 0.0 : value, digits);
}

void draw_axes(std::string& svg, const Panel& p, bool time_label) {
  const double t_step = tick_step(p.t_max - p.t_min, 10.0);
  for (double i = std::ceil(p.t_min / t_step); i * t_step <= p.t_max; i += 1.0) {
    line(svg, p.x(i * t_step), p.top, p.x(i * t_step), p.bottom, "#e4e4e4");
    text(svg, p.x(i * t_step), p.bottom + 18.0, "middle", number(i * t_step, t_step));
  }
  const double step = tick_step(p.high - p.low, 6.0);
  for (double i = std::ceil(p.low / step); i * step <= p.high + 1e-9 * step; i += 1.0) {
    line(svg, kLeft, p.y(i * step), kRight, p.y(i * step), "#e4e4e4");
    text(svg, kLeft - 8.0, p.y(i * step) + 4.0, "end", number(i * step, step));
  }
  line(svg, kLeft, p.bottom, kRight, p.bottom, "#333333");
  line(svg, kLeft, p.top, kLeft, p.bottom, "#333333");
  const double middle = 0.5 * (p.top + p.bottom);
  const std::string turn = fmt::format(" transform=\"rotate(-90 22 {:.1f})\"", middle);
  text(svg, 22.0, middle, "middle", p.label, turn.c_str());
  if (time_label) {
    text(svg, 0.5 * (kLeft + kRight), p.bottom + 40.0, "middle", "time / s");
  }
}

/// Minimum and maximum of each pixel column, joined to one line.
void draw_curve(std::string& svg, const Panel& p, const Curve& curve) {
  const std::span<const Sample> samples = curve.samples;
  fmt::format_to(std::back_inserter(svg),
                 "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
                 "stroke-linejoin=\"round\" points=\"",
                 curve.colour, curve.width);
  const auto columns = static_cast<std::size_t>(kRight - kLeft);
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / columns);
  for (std::size_t begin = 0; begin < samples.size(); begin += stride) {
    const std::size_t end = std::min(samples.size(), begin + stride);
    double low = curve.value(samples[begin]);
    double high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = std::min(low, curve.value(samples[i]));
      high = std::max(high, curve.value(samples[i]));
    }
    const double x = p.x(samples[begin].t_s);
    fmt::format_to(std::back_inserter(svg), "{:.1f},{:.1f} ", x, p.y(low));
    if (high > low) {
      fmt::format_to(std::back_inserter(svg), "{:.1f},{:.1f} ", x, p.y(high));
    }
  }
  svg += "\"/>\n";
}

void draw_legend(std::string& svg, double y, const std::vector<Curve>& curves) {
  double x = kRight - 130.0 * static_cast<double>(curves.size());
  for (const Curve& curve : curves) {
    fmt::format_to(std::back_inserter(svg),
                   "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
                   "stroke-width=\"3\"/>\n",
                   x, y - 4.0, x + 24.0, y - 4.0, curve.colour);
    text(svg, x + 30.0, y, "start", curve.name);
    x += 130.0;
  }
}

void draw_panel(std::string& svg, Panel panel, const std::vector<Curve>& curves, bool time_label) {
  for (const Curve& curve : curves) {
    for (const Sample& sample : curve.samples) {
      panel.low = std::min(panel.low, curve.value(sample));
      panel.high = std::max(panel.high, curve.value(sample));
    }
  }
  const double margin = 0.05 * (panel.high - panel.low);
  panel.high += margin;
  panel.low -= panel.low < 0.0 ? margin : 0.0;
  draw_axes(svg, panel, time_label);
  for (const Curve& curve : curves) {
    draw_curve(svg, panel, curve);
  }
  draw_legend(svg, panel.top - 10.0, curves);
}

double size_of(core::Vec3 v) {
  return std::hypot(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}

using Samples = std::span<const Sample>;

double force_size(const Sample& sample) { return size_of(sample.status.force); }

std::vector<Curve> force_curves(Samples samples) {
  return {{"force x", "#0072b2", 1.0, samples,
           [](const Sample& s) { return static_cast<double>(s.status.force.x); }},
          {"force y", "#009e73", 1.0, samples,
           [](const Sample& s) { return static_cast<double>(s.status.force.y); }},
          {"force z", "#d55e00", 1.0, samples,
           [](const Sample& s) { return static_cast<double>(s.status.force.z); }},
          {"force size", "#222222", 1.3, samples, force_size}};
}

std::vector<Curve> depth_curves(Samples samples) {
  return {{"penetration", "#cc79a7", 1.3, samples, [](const Sample& s) {
             const core::Rendering& r = s.status.rendering;
             return r.in_contact ? 1e3 * static_cast<double>(r.penetration_m) : 0.0;
           }}};
}

/// Bars on a logarithmic scale of counts. A count of 1 has a visible height, so that a single long
/// tick among thousands is visible.
void draw_histogram(std::string& svg, const Histogram& histogram) {
  constexpr double kTop = kHeight + 30.0;
  constexpr double kBottom = kHeight + 200.0;
  const double last = histogram.bars.back().from + histogram.bar_width;
  const double end = 1.05 * std::max(last, histogram.bound);
  double most = 1.0;
  for (const Histogram::Bar& bar : histogram.bars) {
    most = std::max(most, bar.count);
  }
  const double decades = std::ceil(std::log10(most));
  const auto x_of = [&](double value) { return kLeft + value / end * (kRight - kLeft); };
  const auto y_of = [&](double count) {
    return kBottom - (std::log10(count) + 1.0) / (decades + 1.0) * (kBottom - kTop);
  };
  for (double decade = 0.0; decade <= decades; decade += 1.0) {
    const double count = std::pow(10.0, decade);
    line(svg, kLeft, y_of(count), kRight, y_of(count), "#e4e4e4");
    text(svg, kLeft - 8.0, y_of(count) + 4.0, "end", fmt::format("{:g}", count));
  }
  const double step = tick_step(end, 8.0);
  for (double value = 0.0; value <= end; value += step) {
    text(svg, x_of(value), kBottom + 20.0, "middle", fmt::format("{:g}", value));
  }
  for (const Histogram::Bar& bar : histogram.bars) {
    const double width = std::max(1.0, x_of(histogram.bar_width) - x_of(0.0) - 0.5);
    fmt::format_to(std::back_inserter(svg),
                   "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                   "height=\"{:.1f}\" fill=\"#0072b2\"/>\n",
                   x_of(bar.from), y_of(bar.count), width, kBottom - y_of(bar.count));
  }
  if (histogram.bound > 0.0) {
    line(svg, x_of(histogram.bound), kTop, x_of(histogram.bound), kBottom, "#d55e00");
    text(svg, x_of(histogram.bound) - 6.0, kTop + 14.0, "end", "proven bound");
  }
  const double middle = 0.5 * (kTop + kBottom);
  const std::string turn = fmt::format(" transform=\"rotate(-90 22 {:.1f})\"", middle);
  text(svg, 22.0, middle, "middle", "ticks", turn.c_str());
  text(svg, 0.5 * (kLeft + kRight), kBottom + 40.0, "middle", histogram.label);
}

std::string begin_page(const std::string& title, double height = kHeight) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      kWidth, height);
  text(svg, kLeft, 28.0, "start", escaped(title), " font-size=\"16\" font-weight=\"bold\"");
  return svg;
}

/// A panel over the duration of the samples.
Panel panel_over(Samples samples, double top, double bottom, const char* label) {
  const double t_min = samples.empty() ? 0.0 : samples.front().t_s;
  const double t_last = samples.empty() ? 1.0 : samples.back().t_s;
  return {top, bottom, t_min, t_last > t_min ? t_last : t_min + 1.0, 0.0, 1e-3, label};
}

/// Samples with begin_s <= t_s < end_s.
Samples cut(Samples samples, double begin_s, double end_s) {
  const auto later = [](const Sample& s, double t_s) { return s.t_s < t_s; };
  const auto first = std::lower_bound(samples.begin(), samples.end(), begin_s, later);
  const auto last = std::lower_bound(first, samples.end(), end_s, later);
  return {first, last};
}

std::vector<Curve> mode_curves(Samples surface, Samples paper) {
  return {{"paper mode", "#d55e00", 0.8, paper, force_size},
          {"surface mode", "#0072b2", 1.6, surface, force_size}};
}

}  // namespace

std::string plot_svg(std::span<const Sample> samples, const std::string& title,
                     const Histogram& histogram) {
  const bool has_bars = !histogram.bars.empty();
  std::string svg = begin_page(title, has_bars ? kHeight + 250.0 : kHeight);
  draw_panel(svg, panel_over(samples, 70.0, 340.0, "force / N"), force_curves(samples), false);
  draw_panel(svg, panel_over(samples, 400.0, 580.0, "penetration / mm"), depth_curves(samples),
             true);
  if (has_bars) {
    draw_histogram(svg, histogram);
  }
  svg += "</svg>\n";
  return svg;
}

std::string plot_modes_svg(std::span<const Sample> surface, std::span<const Sample> paper,
                           const std::string& title) {
  constexpr double kZoomS = 0.25;
  std::string svg = begin_page(title);
  const Panel whole = panel_over(surface, 70.0, 300.0, "force / N");
  draw_panel(svg, whole, mode_curves(surface, paper), false);
  const double middle = 0.5 * (whole.t_min + whole.t_max);
  const Samples near_surface = cut(surface, middle, middle + kZoomS);
  const Samples near_paper = cut(paper, middle, middle + kZoomS);
  draw_panel(svg, panel_over(near_surface, 360.0, 580.0, "force / N, detail"),
             mode_curves(near_surface, near_paper), true);
  svg += "</svg>\n";
  return svg;
}

}  // namespace tactree::simulation
