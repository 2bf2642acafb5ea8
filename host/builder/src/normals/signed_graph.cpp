#include "normals/signed_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "geometry/local_points.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kGraphNeighbours = 10;
constexpr double kFarthestEdgeSpacings = 3.0;
constexpr double kUsualReachSpacings = 2.3;  // a disc of this radius holds these neighbours
// A steeper chord than across an edge of 90 degrees passes through the body instead of along its
// surface.
constexpr float kMaxChordSlope = 0.75F;
// Below this agreement the relative sign is unknown.
constexpr float kLeastAgreement = 0.5F;
// Two sets are not joined if both have more evidence than this and it is contradictory.
constexpr float kContradiction = 1.5F;

// Relative sign of the normals of two points, and its certainty; 0 if unknown.
float weight_of(const ZOrderedCloud& points, std::span<const Eigen::Vector3f> normals,
                std::uint32_t from, std::uint32_t to) {
  const Eigen::Vector3f chord =
      (points.positions()[to] - points.positions()[from]).normalized().cast<float>();
  const float rise_from = normals[from].dot(chord);
  const float rise_to = normals[to].dot(chord);
  if (std::abs(rise_from) > kMaxChordSlope || std::abs(rise_to) > kMaxChordSlope) {
    return 0.0F;
  }
  const float agreement = normals[to].dot(normals[from] - 2.0F * rise_from * chord);
  const float certainty = (std::abs(agreement) - kLeastAgreement) / (1.0F - kLeastAgreement) -
                          std::abs(rise_from * rise_to);
  return certainty > 0.0F ? std::copysign(certainty, agreement) : 0.0F;
}

using Nearest = std::array<std::uint32_t, kGraphNeighbours>;

std::vector<Nearest> nearest_neighbours(const ZOrderedCloud& points, double spacing) {
  const double farthest = kFarthestEdgeSpacings * spacing;
  std::vector<Nearest> nearest(points.size());
  for_each_with_local(
      points, points, kUsualReachSpacings * spacing, [&](LocalPoints& local, std::uint32_t i) {
        thread_local std::vector<Neighbour> found;
        local.find_nearest_unsorted(points.positions()[i], kGraphNeighbours + 1, found);
        std::sort(found.begin(), found.end());
        nearest[i].fill(i);
        std::size_t count = 0;
        for (const Neighbour& n : found) {
          if (n.index != i && count < kGraphNeighbours &&
              n.squared_distance <= farthest * farthest) {
            nearest[i][count++] = n.index;
          }
        }
      });
  return nearest;
}

void add_links_of(std::uint32_t i, const ZOrderedCloud& points,
                  std::span<const Eigen::Vector3f> normals, const std::vector<Nearest>& nearest,
                  std::vector<SignedLink>& links) {
  for (const std::uint32_t j : nearest[i]) {
    const bool listed_by_lower =
        j < i && std::find(nearest[j].begin(), nearest[j].end(), i) != nearest[j].end();
    if (j == i || listed_by_lower) {
      continue;
    }
    const float weight = weight_of(points, normals, i, j);
    if (weight != 0.0F) {
      links.push_back({j, weight});
    }
  }
}

// Union-find that stores the sign of each member relative to the root.
class SignedSets {
 public:
  explicit SignedSets(std::span<const float> evidence)
      : parent_(evidence.size()),
        reversed_(evidence.size(), 0),
        evidence_(evidence.begin(), evidence.end()) {
    const std::size_t size = evidence.size();
    for (std::uint32_t i = 0; i < size; ++i) {
      parent_[i] = i;
    }
  }

  struct Place {
    std::uint32_t root;
    std::uint8_t reversed;
  };
  Place find(std::uint32_t i) {
    std::uint32_t root = i;
    std::uint8_t reversed = 0;
    while (parent_[root] != root) {
      reversed ^= reversed_[root];
      root = parent_[root];
    }
    const Place place{root, reversed};
    while (parent_[i] != root) {  // path compression
      const std::uint32_t next = parent_[i];
      const std::uint8_t own = reversed_[i];
      parent_[i] = root;
      reversed_[i] = reversed;
      reversed ^= own;
      i = next;
    }
    return place;
  }
  // The lowest member becomes the root.
  void join(std::uint32_t from, SignedLink link) {
    const Place a = find(from);
    const Place b = find(link.to);
    if (a.root == b.root) {
      return;
    }
    const bool reverse = (a.reversed ^ b.reversed ^ (link.weight < 0.0F ? 1 : 0)) != 0;
    const float of_a = evidence_[a.root];
    const float of_b = reverse ? -evidence_[b.root] : evidence_[b.root];
    if (of_a * of_b < 0.0F && std::min(std::abs(of_a), std::abs(of_b)) > kContradiction) {
      return;
    }
    const std::uint32_t root = std::min(a.root, b.root);
    const std::uint32_t joined = std::max(a.root, b.root);
    parent_[joined] = root;
    reversed_[joined] = reverse ? 1 : 0;
    evidence_[root] = root == a.root || !reverse ? of_a + of_b : -(of_a + of_b);
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> reversed_;
  std::vector<float> evidence_;  // per root: evidence of its set
};

}  // namespace

SignedGraph signed_graph(const ZOrderedCloud& points, std::span<const Eigen::Vector3f> normals,
                         double spacing) {
  std::vector<Nearest> nearest = nearest_neighbours(points, spacing);
  // Each part of the points has a list of its own, so that their order does not depend on threads.
  constexpr std::size_t kPart = 8192;
  std::vector<std::vector<SignedLink>> parts((points.size() + kPart - 1) / kPart);
  SignedGraph graph;
  graph.first.resize(points.size() + 1);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const auto end = static_cast<std::uint32_t>(std::min(points.size(), (part + 1) * kPart));
    parts[part].reserve(6 * kPart);
    for (auto i = static_cast<std::uint32_t>(part * kPart); i < end; ++i) {
      const std::size_t before = parts[part].size();
      add_links_of(i, points, normals, nearest, parts[part]);
      graph.first[i + 1] = static_cast<std::uint32_t>(parts[part].size() - before);
    }
  });
  nearest = {};
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.links.reserve(graph.first.back());
  for (std::vector<SignedLink>& part : parts) {
    graph.links.insert(graph.links.end(), part.begin(), part.end());
    part = {};
  }
  return graph;
}

SignedGraph transposed(const SignedGraph& graph) {
  SignedGraph result;
  result.first.resize(graph.first.size());
  for (const SignedLink& link : graph.links) {
    ++result.first[link.to + 1];
  }
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.links.resize(graph.links.size());
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    for (const SignedLink& link : graph.of(i)) {
      result.links[next[link.to]++] = {i, link.weight};
    }
  }
  return result;
}

Patches certain_patches(const SignedGraph& graph, std::span<const float> evidence,
                        float least_weight) {
  const std::size_t points = evidence.size();
  // Sorts by certainty in steps, the most certain first: a counting sort.
  constexpr std::size_t kCertaintySteps = 64;
  const auto step_of = [&](SignedLink link) -> std::size_t {
    const float certainty = std::min(std::abs(link.weight), 1.0F);
    return kCertaintySteps - static_cast<std::size_t>(kCertaintySteps * certainty);
  };
  struct Certain {
    std::uint32_t from;
    std::uint32_t link;
  };
  std::array<std::size_t, kCertaintySteps + 2> first_of_step{};
  const auto for_each_certain = [&](auto&& visit) {
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
      for (std::uint32_t k = graph.first[i]; k < graph.first[i + 1]; ++k) {
        if (std::abs(graph.links[k].weight) >= least_weight) {
          visit(Certain{i, k});
        }
      }
    }
  };
  for_each_certain([&](Certain c) { ++first_of_step[step_of(graph.links[c.link]) + 1]; });
  std::partial_sum(first_of_step.begin(), first_of_step.end(), first_of_step.begin());
  std::vector<Certain> by_certainty(first_of_step.back());
  for_each_certain(
      [&](Certain c) { by_certainty[first_of_step[step_of(graph.links[c.link])]++] = c; });
  SignedSets sets(evidence);
  for (const Certain& c : by_certainty) {
    sets.join(c.from, graph.links[c.link]);
  }
  Patches patches;
  patches.of_point.resize(points);
  patches.reversed.resize(points);
  for (std::uint32_t i = 0; i < points; ++i) {
    const SignedSets::Place place = sets.find(i);
    patches.of_point[i] = place.root == i ? patches.count++ : patches.of_point[place.root];
    patches.reversed[i] = place.reversed;
  }
  return patches;
}

}  // namespace tactree::builder
