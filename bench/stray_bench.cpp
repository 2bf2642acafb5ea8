// Stray points that the cleaning of a scan removes, as a Markdown table.
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "cleaning/cleaning.hpp"
#include "geometry/spacing.hpp"
#include "known_bodies.hpp"
#include "orientation_score.hpp"

namespace {

using namespace tactree;
using bench::KnownCloud;
using builder::ZOrderedCloud;

struct Body {
  std::string name;
  std::function<KnownCloud(std::size_t)> make;
};

std::vector<Body> bodies() {
  using S = std::size_t;
  return {
      {"torus knot", [](S n) { return bench::torus_knot(n, 5.0, 1); }},
      {"head with ears", [](S n) { return bench::head_with_ears(n, 4.0, 1); }},
      {"open relief", [](S n) { return bench::open_relief(n, 1); }},
      {"gear", [](S n) { return bench::thin_gear(n, 4.0, 1); }},
      {"plate of 3 spacings", [](S n) { return bench::flat_plate(n, 3.0, 1); }},
  };
}

// Height of a position over the surface, in spacings.
double height_over(const Eigen::Vector3d& p, const ZOrderedCloud& surface) {
  std::vector<builder::Neighbour> found;
  surface.find_nearest(p, 3, 2.0, found);
  double height = std::sqrt(found[0].squared_distance);
  if (height < 3.0) {
    height = 1e9;
    for (const builder::Neighbour& n : found) {
      const Eigen::Vector3d d = p - surface.positions()[n.index];
      height = std::min(height, std::abs(d.dot(surface.normals()[n.index].cast<double>())));
    }
  }
  return height;
}

double random_at(std::uint64_t i) {
  return std::ldexp(static_cast<double>(builder::hash64(i) >> 11), -53);
}

struct Share {
  std::size_t of = 0;
  std::size_t part = 0;
  [[nodiscard]] std::string text() const {
    return of == 0
               ? "-"
               : fmt::format("{:.2f}", 100.0 * static_cast<double>(part) / static_cast<double>(of));
  }
};

void print_row(const Body& body, std::size_t points, double noise, double part) {
  KnownCloud cloud = body.make(points);
  builder::Cloud known;
  known.positions = cloud.positions;
  for (const Eigen::Vector3d& n : cloud.normals) {
    known.normals.push_back(n.cast<float>());
  }
  const ZOrderedCloud surface(known);
  if (noise > 0.0) {
    bench::add_noise(cloud, noise, 1);
  }
  const builder::Box box = builder::bounds_of(cloud.positions);
  const std::size_t scan = cloud.positions.size();
  const auto strays = static_cast<std::uint64_t>(part * static_cast<double>(scan));
  builder::BuildOptions options;
  builder::BuildReport report;
  const double clean_spacing =
      builder::clean({bench::scan_of(cloud)}, options, report).points_spacing;
  Share removed;
  Share removed_off;
  std::vector<double> heights(scan, -1.0);
  for (std::uint64_t i = 0; i < strays; ++i) {
    const Eigen::Vector3d at(random_at(3 * i), random_at(3 * i + 1), random_at(3 * i + 2));
    cloud.positions.emplace_back(box.min() + at.cwiseProduct(box.sizes()));
    heights.push_back(height_over(cloud.positions.back(), surface));
  }
  builder::Scan tried = bench::scan_of(cloud);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {  // mark the points by their normals
    const auto number = static_cast<float>(i);
    tried.normals.emplace_back(number, 1.0F, 0.0F);
  }
  report = {};
  const builder::CleanInput cleaned = builder::clean({tried}, options, report);
  std::vector<bool> kept(cloud.positions.size(), false);
  for (const Eigen::Vector3f& n : cleaned.points.normals()) {
    kept[static_cast<std::size_t>(std::lround(n.x() / n.y()))] = true;
  }
  Share lost{scan, 0};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i < scan) {
      lost.part += kept[i] ? 0U : 1U;
      continue;
    }
    ++removed.of;
    removed.part += kept[i] ? 0U : 1U;
    if (heights[i] > 1.0 + 2.0 * noise) {
      ++removed_off.of;
      removed_off.part += kept[i] ? 0U : 1U;
    }
  }
  fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.3f} |\n", body.name, points, noise,
             100.0 * part, removed.text(), removed_off.text(), lost.text(),
             cleaned.points_spacing / clean_spacing);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t points = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100'000;
  fmt::print(
      "Stray points spread evenly over the bounding box of a raw cloud. Lengths and noise in "
      "spacings of the cloud; \"off the surface\": by more than one spacing and twice the noise. "
      "Nearer ones cannot be told from the points of the surface.\n\n"
      "| cloud | points | noise | stray, % | removed, % | of those off the surface | points lost, "
      "% "
      "| spacing, relative |\n|---|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const Body& body : bodies()) {
    for (const double noise : {0.0, 0.2}) {
      for (const double part : {0.005, 0.05}) {
        print_row(body, points, noise, part);
      }
    }
  }
}
