// Nearest point within R on the paper's kind of surface, z = cos x + cos y: core::nearest_within()
// on a blob beside nanoflann's kd-tree, in one run, on the same points.
//
// usage: nearest_bench [--spacing M] [--instructions]
//   --spacing M      of the surface, 5 m x 5 m (default 0.0025: 4 004 001 points)
//   --instructions   count them per query as well, by single stepping (a minute)
//
// Prints a table. Exit code 1 when the two do not find the same points.

#include <fmt/core.h>
#include <x86intrin.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <nanoflann.hpp>
#include <random>
#include <string>
#include <vector>

#include "instruction_counter.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/core/model/nearest.hpp"

namespace {

using tactree::core::BlobView;
using tactree::core::Vec3;

constexpr double kHalfWidth = 2.5;
constexpr double kMiddleHeight = 0.2;  // of cos x + cos y over the square
constexpr std::size_t kPathProbes = 6820;
constexpr std::size_t kRandomProbes = 100000;
constexpr std::size_t kWarmUpProbes = 100;
constexpr int kPathPasses = 101;
constexpr int kRandomPasses = 15;
constexpr std::size_t kCountEvery = 31;  // of the path, for instructions

struct Options {
  double spacing = 0.0025;
  bool instructions = false;
};

double height(double x, double y) { return std::cos(x) + std::cos(y) - kMiddleHeight; }

tactree::builder::Model make_surface(double spacing) {
  tactree::builder::Model model;
  const auto n = static_cast<int>(std::lround(2.0 * kHalfWidth / spacing));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = -kHalfWidth + spacing * i;
      const double y = -kHalfWidth + spacing * j;
      model.positions.emplace_back(x, y, height(x, y));
      model.normals.push_back(
          Eigen::Vector3d(std::sin(x), std::sin(y), 1.0).normalized().cast<float>());
    }
  }
  model.spacing_m = spacing;
  model.support_radius_m = 2.0 * spacing;
  model.reach_m = 2.0 * spacing;
  model.name = "cos x + cos y";
  return model;
}

Vec3 above(double x, double y, double offset) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(height(x, y) + offset)};
}

// A hand at 1 kHz: loops at 0.1 to 0.3 m/s, now tracing within half a spacing of the surface, now
// hovering up to three spacings above it.
std::vector<Vec3> hand_path(double spacing) {
  std::vector<Vec3> probes;
  for (std::size_t i = 0; i < kPathProbes; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    const double x = 0.4 + 0.11 * std::sin(1.7 * t) + 0.02 * std::sin(9.1 * t);
    const double y = -0.7 + 0.13 * std::sin(1.3 * t + 1.0) + 0.015 * std::sin(7.7 * t);
    const bool hovers = std::sin(2.1 * t) > 0.3;
    const double offset = hovers ? 3.0 * std::sin(2.1 * t) : 0.5 * std::sin(31.0 * t);
    probes.push_back(above(x, y, spacing * offset));
  }
  return probes;
}

std::vector<Vec3> random_probes(double spacing) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.99 * kHalfWidth, 0.99 * kHalfWidth);
  std::uniform_real_distribution<double> offset(-1.5 * spacing, 1.5 * spacing);
  std::vector<Vec3> probes;
  for (std::size_t i = 0; i < kRandomProbes; ++i) {
    const double x = place(random);
    const double y = place(random);
    probes.push_back(above(x, y, offset(random)));
  }
  return probes;
}

struct Answer {
  std::uint32_t index = tactree::core::kNoPoint;
  float distance_squared = 0.0F;
};

class Ours {
 public:
  Ours(const BlobView& view, float radius) : view_(view), radius_(radius) {}
  Answer operator()(Vec3 probe) const {
    const auto nearest = tactree::core::nearest_within(view_, probe, radius_);
    return {nearest.index, nearest.distance_squared};
  }

 private:
  BlobView view_;
  float radius_;
};

struct Cloud {
  std::vector<Vec3> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    const Vec3& p = points[index];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// One nearest point, none beyond the radius.
class NearestWithin {
 public:
  using DistanceType = float;
  explicit NearestWithin(float radius) : answer_{tactree::core::kNoPoint, radius * radius} {}
  [[nodiscard]] std::size_t size() const {
    return answer_.index == tactree::core::kNoPoint ? 0 : 1;
  }
  [[nodiscard]] bool full() const { return true; }
  [[nodiscard]] float worstDist() const { return answer_.distance_squared; }
  bool addPoint(float distance, std::uint32_t index) {
    if (distance < answer_.distance_squared) {  // worstDist() is asked once a leaf only
      answer_ = {index, distance};
    }
    return true;
  }
  [[nodiscard]] Answer answer() const { return answer_; }

 private:
  Answer answer_;
};

class Nanoflann {
 public:
  Nanoflann(const Cloud& cloud, float radius)
      : tree_(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)), radius_(radius) {
    tree_.buildIndex();
  }
  Answer operator()(Vec3 probe) const {
    NearestWithin nearest(radius_);
    const float query[3] = {probe.x, probe.y, probe.z};
    tree_.findNeighbors(nearest, query, nanoflann::SearchParams());
    return nearest.answer();
  }
  [[nodiscard]] double bytes_per_point(const Cloud& cloud) {
    return static_cast<double>(tree_.usedMemory(tree_)) / static_cast<double>(cloud.points.size()) +
           sizeof(Vec3);
  }

 private:
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>,
                                                   Cloud, 3, std::uint32_t>;
  Tree tree_;
  float radius_;
};

Cloud decode(const BlobView& view) {
  Cloud cloud;
  for_each_point(view, [&](const tactree::core::Leaf& leaf, std::uint32_t index) {
    cloud.points.push_back(view.position(leaf, index));
  });
  return cloud;
}

// Both see the same float32 points, but round their distances differently.
std::size_t count_differences(const Ours& ours, const Nanoflann& peer,
                              const std::vector<Vec3>& probes, float radius) {
  std::size_t differences = 0;
  for (const Vec3& probe : probes) {
    const Answer a = ours(probe);
    const Answer b = peer(probe);
    // Nothing found counts as the radius: a point on its boundary is found by one or the other.
    const bool found = a.index != tactree::core::kNoPoint;
    const float a_distance = found ? std::sqrt(a.distance_squared) : radius;
    const float b_distance = std::sqrt(b.distance_squared);
    differences += std::abs(a_distance - b_distance) > 1e-6F ? 1U : 0U;
  }
  return differences;
}

std::uint64_t clock_now() {
  _mm_lfence();
  const std::uint64_t now = __rdtsc();
  _mm_lfence();
  return now;
}

double nanoseconds_per_count() {
  const auto begin = std::chrono::steady_clock::now();
  const std::uint64_t first = clock_now();
  while (std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(200)) {
  }
  const std::uint64_t last = clock_now();
  const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;
  return elapsed.count() / static_cast<double>(last - first);
}

volatile std::uint32_t sink;

// The last probes come first, untimed: a hand was there before, and the other structure's turn has
// left the caches cold. Times are written one behind the other, to disturb them little.
template <class Query>
std::vector<std::uint64_t> time_pass(const Query& query, const std::vector<Vec3>& probes) {
  std::vector<std::uint64_t> times(probes.size());
  for (std::size_t i = probes.size() - kWarmUpProbes; i < probes.size(); ++i) {
    sink = query(probes[i]).index;
  }
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const std::uint64_t begin = clock_now();
    const Answer answer = query(probes[i]);
    sink = answer.index;
    times[i] = clock_now() - begin;
  }
  return times;
}

// The mean of the faster half: what the rest of the machine does only ever slows a call down, and
// the mean is finer than a tick of the clock, which may be 10 ns.
double typical(std::vector<std::uint64_t> repeats) {
  std::sort(repeats.begin(), repeats.end());
  const std::size_t half = (repeats.size() + 1) / 2;
  double sum = 0.0;
  for (std::size_t i = 0; i < half; ++i) {
    sum += static_cast<double>(repeats[i]);
  }
  return sum / static_cast<double>(half);
}

struct Distribution {
  double median = 0.0;
  double permille_999 = 0.0;
  double worst = 0.0;
};

Distribution distribution_of(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return {v[v.size() / 2], v[std::min(v.size() - 1, v.size() * 999 / 1000)], v.back()};
}

struct Pair {
  Distribution ours;
  Distribution peer;
};

using Passes = std::vector<std::vector<std::uint64_t>>;

std::vector<double> to_nanoseconds(const Passes& passes, double per_count, double overhead) {
  std::vector<double> result;
  std::vector<std::uint64_t> repeats(passes.size());
  for (std::size_t i = 0; i < passes.front().size(); ++i) {
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
      repeats[pass] = passes[pass][i];
    }
    result.push_back(std::max(0.0, per_count * typical(repeats) - overhead));
  }
  return result;
}

// Passes take turns, so that a slow moment of the machine meets both.
Pair time_both(const Ours& ours, const Nanoflann& peer, const std::vector<Vec3>& probes,
               int passes) {
  Passes ours_times;
  Passes peer_times;
  Passes empty_times;
  const auto nothing = [](Vec3) { return Answer{}; };
  for (int pass = 0; pass < passes; ++pass) {
    ours_times.push_back(time_pass(ours, probes));
    peer_times.push_back(time_pass(peer, probes));
    empty_times.push_back(time_pass(nothing, probes));
  }
  const double per_count = nanoseconds_per_count();
  const double overhead = distribution_of(to_nanoseconds(empty_times, per_count, 0.0)).median;
  return {distribution_of(to_nanoseconds(ours_times, per_count, overhead)),
          distribution_of(to_nanoseconds(peer_times, per_count, overhead))};
}

Pair count_both(const Ours& ours, const Nanoflann& peer, const std::vector<Vec3>& probes) {
  const auto count = [&](const auto& query) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      const auto counts = tactree::bench::count_instructions(
          probes.size(), [&](std::size_t i) { sink = query(probes[i]).index; });
      if (!counts.empty()) {
        return distribution_of(std::vector<double>(counts.begin(), counts.end()));
      }
    }
    fmt::print(stderr, "nearest_bench: the instructions of a query were not counted; try again\n");
    std::exit(1);
  };
  return {count(ours), count(peer)};
}

void print_row(const char* name, double ours, double peer) {
  fmt::print("| {:<36} | {:>9.5g} | {:>9.5g} | {:>6.2f} |\n", name, ours, peer, ours / peer);
}

void print_rows(const std::string& name, const Pair& pair) {
  print_row((name + ", median").c_str(), pair.ours.median, pair.peer.median);
  print_row((name + ", 99.9 %").c_str(), pair.ours.permille_999, pair.peer.permille_999);
  print_row((name + ", worst").c_str(), pair.ours.worst, pair.peer.worst);
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--spacing") == 0 && i + 1 < argc) {
      options.spacing = std::strtod(argv[++i], nullptr);
    } else if (std::strcmp(argv[i], "--instructions") == 0) {
      options.instructions = true;
    } else {
      fmt::print(stderr, "usage: nearest_bench [--spacing M] [--instructions]\n");
      std::exit(2);
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  const auto written = tactree::builder::write_blob(make_surface(options.spacing));
  BlobView view;
  if (tactree::core::open_blob(written.bytes, view) != tactree::core::BlobStatus::kOk) {
    return 1;
  }
  const Cloud cloud = decode(view);
  const float radius = view.reach_m();
  const Ours ours(view, radius);
  Nanoflann peer(cloud, radius);
  const std::vector<Vec3> path = hand_path(options.spacing);
  const std::vector<Vec3> random = random_probes(options.spacing);

  const std::size_t differences =
      count_differences(ours, peer, path, radius) + count_differences(ours, peer, random, radius);
  fmt::print("{} points, {} m apart, radius {} m; {} of {} probes answered differently\n\n",
             cloud.points.size(), options.spacing, radius, differences,
             path.size() + random.size());
  fmt::print("| {:<36} | {:>9} | {:>9} | {:>6} |\n|{:-<38}|{:->10}:|{:->10}:|{:->7}:|\n",
             "nearest point within 2 spacings", "Tactree", "nanoflann", "ratio", "", "", "", "");
  print_rows("hand's path, ns", time_both(ours, peer, path, kPathPasses));
  print_rows("random probes, ns", time_both(ours, peer, random, kRandomPasses));
  if (options.instructions) {
    std::vector<Vec3> some;
    for (std::size_t i = 0; i < path.size(); i += kCountEvery) {
      some.push_back(path[i]);
    }
    print_rows("hand's path, instructions", count_both(ours, peer, some));
  }
  const auto& header = view.header();
  const double points = header.point_count;
  print_row("bytes a point (ours with normals)", header.total_bytes / points,
            peer.bytes_per_point(cloud));
  fmt::print("\nBytes a point without normals: {:.2f}. Bound: {} leaves, {} points a query.\n",
             (header.total_bytes - header.normals.bytes) / points, header.leaves_per_query_max,
             header.points_per_query_max);
  return differences == 0 ? 0 : 1;
}
