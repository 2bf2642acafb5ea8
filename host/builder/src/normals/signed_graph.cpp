#include "normals/signed_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

void add_edges_of(std::uint32_t i, const ZOrderedCloud& points,
                  std::span<const Eigen::Vector3f> normals, const std::vector<Nearest>& nearest,
                  std::vector<SignedEdge>& edges) {
  for (const std::uint32_t j : nearest[i]) {
    // If both ends list the edge, the lower one adds it.
    const bool listed_by_lower =
        j < i && std::find(nearest[j].begin(), nearest[j].end(), i) != nearest[j].end();
    if (j == i || listed_by_lower) {
      continue;
    }
    const float weight = weight_of(points, normals, i, j);
    if (weight != 0.0F) {
      edges.push_back({std::min(i, j), std::max(i, j), weight});
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
  void join(const SignedEdge& edge) {
    const Place a = find(edge.from);
    const Place b = find(edge.to);
    if (a.root == b.root) {
      return;
    }
    const bool reverse = (a.reversed ^ b.reversed ^ (edge.weight < 0.0F ? 1 : 0)) != 0;
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

std::vector<SignedEdge> signed_graph(const ZOrderedCloud& points,
                                     std::span<const Eigen::Vector3f> normals, double spacing) {
  const std::vector<Nearest> nearest = nearest_neighbours(points, spacing);
  // Each part of the points has a list of its own, so that their order does not depend on threads.
  constexpr std::size_t kPart = 8192;
  std::vector<std::vector<SignedEdge>> parts((points.size() + kPart - 1) / kPart);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const auto end = static_cast<std::uint32_t>(std::min(points.size(), (part + 1) * kPart));
    parts[part].reserve(6 * kPart);
    for (auto i = static_cast<std::uint32_t>(part * kPart); i < end; ++i) {
      add_edges_of(i, points, normals, nearest, parts[part]);
    }
  });
  std::size_t count = 0;
  for (const std::vector<SignedEdge>& part : parts) {
    count += part.size();
  }
  std::vector<SignedEdge> edges;
  edges.reserve(count);
  for (std::vector<SignedEdge>& part : parts) {
    edges.insert(edges.end(), part.begin(), part.end());
    part = {};
  }
  return edges;
}

Patches certain_patches(const std::vector<SignedEdge>& edges, std::span<const float> evidence,
                        float least_weight) {
  const std::size_t points = evidence.size();
  // Sorts by certainty in steps, which makes it a counting sort.
  constexpr int kCertaintySteps = 64;
  std::array<std::vector<std::uint32_t>, kCertaintySteps + 1> by_certainty;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const float certainty = std::abs(edges[e].weight);
    if (certainty >= least_weight) {
      by_certainty[static_cast<std::size_t>(kCertaintySteps * std::min(certainty, 1.0F))].push_back(
          e);
    }
  }
  SignedSets sets(evidence);
  for (auto step = by_certainty.rbegin(); step != by_certainty.rend(); ++step) {
    for (const std::uint32_t e : *step) {
      sets.join(edges[e]);
    }
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
