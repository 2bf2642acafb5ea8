#include "hole_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "svg.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
namespace {

using builder::Opening;

constexpr double kSide = 290.0;  // of the square of a view, pixels
constexpr double kGap = 15.0;
constexpr double kViewTop = 30.0;
constexpr double kBottom = kViewTop + kSide + 40.0;
constexpr std::uint32_t kDots = 4000;  // maximum per view; enough to recognise a model
constexpr std::size_t kListed = 10;    // maximum rows of the table of a scan

const char* name_of(Opening::Kind kind) {
  return kind == Opening::Kind::kHole ? "hole" : "boundary";
}

std::string map_name(std::size_t scan) { return fmt::format("holes_{}.svg", scan); }

/// Axes of the model that point right and up in a view.
struct Side {
  const char* name;
  Eigen::Index right;
  Eigen::Index up;
};
constexpr std::array<Side, 3> kSides = {
    {{"along y: x, z", 0, 2}, {"along x: y, z", 1, 2}, {"along z: x, y", 0, 1}}};

const char* colour_of(Opening::Kind kind) {
  return kind == Opening::Kind::kHole ? "#d6191f" : "#ee8c0f";
}

/// Projection of the model to the picture, with the same scale in all views.
class Projection {
 public:
  explicit Projection(const core::BlobHeader& header) {
    const Eigen::Vector3f low(header.bounds_min_m);
    const Eigen::Vector3f high(header.bounds_max_m);
    middle_ = (0.5F * (low + high)).cast<double>();
    scale_ = kSide / std::max(1e-9, static_cast<double>((high - low).maxCoeff()));
  }
  [[nodiscard]] static double middle_of(std::size_t view) {
    return 0.5 * kSide + static_cast<double>(view) * (kSide + kGap);
  }
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector3d& at, std::size_t view) const {
    const Side& side = kSides[view];
    return {middle_of(view) + scale_ * (at[side.right] - middle_[side.right]),
            kViewTop + 0.5 * kSide - scale_ * (at[side.up] - middle_[side.up])};
  }
  [[nodiscard]] double pixels(double metres) const { return scale_ * metres; }

 private:
  Eigen::Vector3d middle_;
  double scale_ = 1.0;
};

/// At most kDots points of a view in one path; a line of length 0 with round caps is a dot.
std::string dots(const core::BlobView& view, const Projection& frame, std::size_t side) {
  const std::uint32_t every = 1U + view.point_count() / kDots;
  std::string path;
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    if (index % every != 0U) {
      return;
    }
    const core::Vec3 p = view.surface_point(leaf, index).position;
    const Eigen::Vector2d at = frame.place(Eigen::Vector3f(p.x, p.y, p.z).cast<double>(), side);
    fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}h0", at.x(), at.y());
  });
  return fmt::format(
      "<path d=\"{}\" stroke=\"#b9bfc6\" stroke-width=\"1.6\" stroke-linecap=\"round\"/>\n", path);
}

std::string circle(const Opening& opening, const Projection& frame, std::size_t side) {
  constexpr double kLeast = 2.5;  // pixels; a smaller circle is hardly visible
  const Eigen::Vector2d at = frame.place(opening.centre, side);
  const double radius = std::max(kLeast, 0.5 * frame.pixels(opening.diameter_m));
  return fmt::format(
      "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\" fill=\"{3}\" fill-opacity=\"0.2\" "
      "stroke=\"{3}\"/>\n",
      at.x(), at.y(), radius, colour_of(opening.kind));
}

}  // namespace

std::string hole_map_svg(const core::BlobView& view, std::span<const Opening> openings) {
  const Projection frame(view.header());
  const double width = 3.0 * kSide + 2.0 * kGap;
  std::string svg = begin_svg(width, kBottom);
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    add_text(svg, Projection::middle_of(side), 18.0, "middle", kSides[side].name);
    svg += dots(view, frame, side);
    for (const Opening& opening : openings) {
      svg += circle(opening, frame, side);
    }
  }
  return svg + kSvgEnd;
}

std::map<std::string, std::string> hole_maps(const Result& result) {
  std::map<std::string, std::string> maps;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    if (result.scans[i].error.empty()) {
      maps[map_name(i)] = result.scans[i].hole_map;
    }
  }
  return maps;
}

std::string holes_markdown(const Result& result) {
  std::string page;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    const ScanResult& scan = result.scans[i];
    if (!scan.error.empty()) {
      continue;
    }
    fmt::format_to(
        std::back_inserter(page),
        "\n## Openings of {}\nOpenings wider than the {:.3g} mm that the surface fit bridges: {}. "
        "Red: a hole, enclosed by surface; orange: an open boundary.\n\n"
        "![Openings of {}]({})\n",
        scan.name, 1e3 * scan.bridged_m, scan.openings.size(), scan.name, map_name(i));
    if (!scan.openings.empty()) {
      page += "\n| opening | width, mm | centre x, y, z, mm |\n|---|---|---|\n";
    }
    for (std::size_t k = 0; k < std::min(kListed, scan.openings.size()); ++k) {
      const Opening& o = scan.openings[k];
      fmt::format_to(std::back_inserter(page), "| {} | {:.2f} | {:.2f}, {:.2f}, {:.2f} |\n",
                     name_of(o.kind), 1e3 * o.diameter_m, 1e3 * o.centre.x(), 1e3 * o.centre.y(),
                     1e3 * o.centre.z());
    }
  }
  return page;
}

}  // namespace tactree::evaluation
