#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "svg.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
namespace {

constexpr double kWidth = 900.0;
constexpr double kLeft = 150.0;
constexpr double kRight = 870.0;
constexpr std::array<const char*, 2> kColours = {"#0072b2", "#d55e00"};

class Svg {
 public:
  Svg(double height, const std::string& title) {
    out_ = begin_svg(kWidth, height);
    text(kLeft, 26.0, "start", title, " font-size=\"16\" font-weight=\"bold\"");
    for (const Mode mode : {kSurface, kPaper}) {
      const double x = kRight - (mode == kSurface ? 180.0 : 80.0);
      bar(x, 38.0, 14.0, mode);
      text(x + 20.0, 50.0, "start", kModeNames[mode]);
    }
  }
  void text(double x, double y, const char* anchor, const std::string& words,
            const char* extra = "") {
    add_text(out_, x, y, anchor, words, extra);
  }
  void bar(double x, double y, double width, Mode mode) {
    fmt::format_to(std::back_inserter(out_),
                   "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"13\" fill=\"{}\"/>\n",
                   x, y, width, kColours[mode]);
  }
  void line(double x1, double y1, double x2, double y2, const char* colour) {
    fmt::format_to(
        std::back_inserter(out_),
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1,
        x2, y2, colour);
  }
  void curve(const std::string& points, Mode mode) {
    out_ += fmt::format("<polyline fill=\"none\" stroke=\"{}\" points=\"{}\"/>\n", kColours[mode],
                        points);
  }
  [[nodiscard]] std::string take() { return std::move(out_) + kSvgEnd; }

 private:
  std::string out_;
};

/// Plot of the force along one slide; the true value is 1 N.
std::string force_plot(const ForceTrace& trace) {
  constexpr double kAxisTop = 70.0;
  constexpr double kAxisBottom = 360.0;
  Svg svg(410.0, "Force while sliding 1 mm deep over: " + trace.title);
  double high = 1.2;
  for (const Mode mode : {kSurface, kPaper}) {
    for (const double force : trace.force_N[mode]) {
      high = std::max(high, 1.05 * force);
    }
  }
  const double length = trace.distance_m.empty() ? 1.0 : trace.distance_m.back();
  const auto x_of = [&](double distance) { return kLeft + distance / length * (kRight - kLeft); };
  const auto y_of = [&](double force) {
    return kAxisBottom - force / high * (kAxisBottom - kAxisTop);
  };
  for (double force = 0.0; force < high; force += 0.5) {
    svg.line(kLeft, y_of(force), kRight, y_of(force), "#e4e4e4");
    svg.text(kLeft - 8.0, y_of(force) + 4.0, "end", fmt::format("{:.1f} N", force));
  }
  for (double distance = 0.0; distance <= length; distance += 0.01) {
    svg.text(x_of(distance), kAxisBottom + 20.0, "middle",
             fmt::format("{:.0f} mm", 1e3 * distance));
  }
  for (const Mode mode : {kPaper, kSurface}) {
    std::string points;
    for (std::size_t i = 0; i < trace.force_N[mode].size(); ++i) {
      points +=
          fmt::format("{:.1f},{:.1f} ", x_of(trace.distance_m[i]), y_of(trace.force_N[mode][i]));
    }
    svg.curve(points, mode);
  }
  return svg.take();
}

/// Bar chart of one score of all shapes, on a logarithmic axis from `low` to `high`.
std::string score_plot(const Result& result, const std::string& score, const std::string& title,
                       double low, double high, const std::string& unit, double scale) {
  constexpr double kFirstRow = 70.0;
  constexpr double kRow = 38.0;
  const double bottom = kFirstRow + kRow * static_cast<double>(result.shapes.size());
  Svg svg(bottom + 50.0, title);
  const auto x_of = [&](double value) {
    const double share = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    return kLeft + share * (kRight - kLeft);
  };
  for (double value = low; value <= 1.001 * high; value *= 10.0) {
    svg.line(x_of(value), kFirstRow - 6.0, x_of(value), bottom, "#e4e4e4");
    svg.text(x_of(value), bottom + 18.0, "middle", fmt::format("{:g} {}", scale * value, unit));
  }
  double y = kFirstRow;
  for (const ShapeResult& shape : result.shapes) {
    svg.text(kLeft - 8.0, y + 18.0, "end", shape.name);
    for (const Mode mode : {kSurface, kPaper}) {
      const double value = shape.modes[mode].get(score);
      if (std::isfinite(value)) {
        svg.bar(kLeft, mode == kSurface ? y : y + 14.0, x_of(value) - kLeft, mode);
      }
    }
    y += kRow;
  }
  return svg.take();
}

}  // namespace

std::map<std::string, std::string> plots(const Result& result) {
  if (result.options.scans_only) {
    return {};
  }
  return {{"force.svg", force_plot(result.trace)},
          {"depth.svg", score_plot(result, "depth_rms_m", "Error of the computed distance, rms",
                                   1e-7, 1e-3, "&#181;m", 1e6)},
          {"normal.svg", score_plot(result, "normal_rms_deg", "Error of the normal, rms", 1e-3, 1e2,
                                    "&#176;", 1.0)},
          {"force_error.svg",
           score_plot(result, "force_error_rms_N", "Error of the force of 1 N while sliding, rms",
                      1e-4, 1.0, "N", 1.0)}};
}

}  // namespace tactree::evaluation
