// Share of points of raw clouds whose side is wrong, as a Markdown table.
#include <fmt/core.h>

#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "known_bodies.hpp"
#include "orientation_score.hpp"

namespace {

using namespace tactree;
using bench::KnownCloud;

struct Row {
  std::string name;
  std::function<KnownCloud(std::size_t, std::uint64_t)> make;
};

std::vector<Row> rows() {
  using S = std::size_t;
  using U = std::uint64_t;
  return {
      {"thin twisted arms, 2.5 spacings", [](S n, U s) { return bench::twisted_arms(n, 2.5, s); }},
      {"thin twisted arms, 4", [](S n, U s) { return bench::twisted_arms(n, 4.0, s); }},
      {"flat long blade, 2.5", [](S n, U s) { return bench::long_blade(n, 2.5, s); }},
      {"gear, teeth of 2.5", [](S n, U s) { return bench::thin_gear(n, 2.5, s); }},
      {"gear, teeth of 4", [](S n, U s) { return bench::thin_gear(n, 4.0, s); }},
      {"head with ears of 3", [](S n, U s) { return bench::head_with_ears(n, 3.0, s); }},
      {"torus knot", [](S n, U s) { return bench::torus_knot(n, 5.0, s); }},
      {"vessel, wall of 3", [](S n, U s) { return bench::vessel(n, 3.0, s); }},
      {"nested shells", [](S n, U s) { return bench::nested_shells(n, s); }},
      {"figure without a base", [](S n, U s) { return bench::open_figure(n, s); }},
      {"figure, 10 views merged, misplaced by 0.7",
       [](S n, U s) { return bench::merged_views(bench::open_figure(n, s), 10, 0.7, s); }},
      {"plate of 1", [](S n, U s) { return bench::flat_plate(n, 1.0, s); }},
      {"plate of 1.5", [](S n, U s) { return bench::flat_plate(n, 1.5, s); }},
      {"plate of 2", [](S n, U s) { return bench::flat_plate(n, 2.0, s); }},
      {"plate of 2.5", [](S n, U s) { return bench::flat_plate(n, 2.5, s); }},
      {"open relief, z up", [](S n, U s) { return bench::open_relief(n, s); }},
  };
}

/// "0.03", with an asterisk if the report calls most of the surface doubtful.
std::string score(const Row& row, std::size_t points, double noise) {
  double worst = 0.0;
  bool doubtful = true;
  for (const std::uint64_t turn : {0U, 1U}) {
    KnownCloud cloud = row.make(points, turn + 1);
    bench::rotate(cloud, row.name.find("relief") == std::string::npos ? turn : 0);
    if (noise > 0.0) {
      bench::add_noise(cloud, noise, turn);
    }
    builder::Progress quiet;
    builder::BuildOptions options;
    options.name = "body";
    const builder::BuildResult built =
        builder::build_model({bench::scan_of(cloud)}, options, quiet);
    const double wrong = bench::wrong_share(cloud, built);
    if (wrong >= worst) {
      worst = wrong;
      doubtful = 2 * built.report.orientation.doubtful_points > built.report.output_points;
    }
  }
  return fmt::format("{:.2f}{}", 100.0 * worst, doubtful ? " \\*" : "");
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t points = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 10'000;
  fmt::print(
      "Points with a wrong side, in %, of raw clouds of about {} independent points, the worse of "
      "two "
      "rotations. Lengths and noise (Gaussian, in each direction) in spacings of the cloud. \\*: "
      "the "
      "report calls it doubtful.\n\n| cloud | noise 0 | 0.2 | 0.35 |\n|---|--:|--:|--:|\n",
      points);
  for (const Row& row : rows()) {
    fmt::print("| {} | {} | {} | {} |\n", row.name, score(row, points, 0.0),
               score(row, points, 0.2), score(row, points, 0.35));
  }
}
