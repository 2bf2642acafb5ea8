#include "normals.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace tactree::builder {
namespace {

constexpr double kFitSpacings = 1.5;
constexpr std::size_t kLeastFitted = 12;
constexpr std::size_t kMostFitted = 96;

// The normal of the plane through neighbours sorted by distance; nearer ones count more.
Eigen::Vector3f fit_normal(const ZOrderedCloud& dense, const std::vector<Neighbour>& neighbours) {
  const double radius_squared = 1.2 * neighbours.back().squared_distance + 1e-300;
  double weight_sum = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& centre = dense.positions()[neighbours.front().index];
  for (const Neighbour& n : neighbours) {
    const double weight = 1.0 - n.squared_distance / radius_squared;
    weight_sum += weight;
    mean += weight * (dense.positions()[n.index] - centre);
  }
  mean /= weight_sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : neighbours) {
    const Eigen::Vector3d d = dense.positions()[n.index] - centre - mean;
    covariance += (1.0 - n.squared_distance / radius_squared) * d * d.transpose();
  }
  covariance /= std::max(covariance.trace(), 1e-300);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  return normal.allFinite() && normal.norm() > 0.5F ? Eigen::Vector3f(normal.normalized())
                                                    : Eigen::Vector3f::UnitZ();
}

struct Edge {
  float weight;  // 0: certain
  std::uint32_t from;
  std::uint32_t to;
  bool opposite;   // the normals' signs disagree
  bool uncertain;  // too little agreement to tell that

  bool operator<(const Edge& other) const {
    if (uncertain != other.uncertain) {
      return other.uncertain;
    }
    if (weight != other.weight) {
      return weight < other.weight;
    }
    return from != other.from ? from < other.from : to < other.to;
  }
};

constexpr std::size_t kGraphNeighbours = 10;
// Steeper than an edge of 90 degrees, a chord leads through the body and not along its surface.
constexpr float kSteepestChord = 0.75F;
// Normals that agree less tell nothing of each other's sign: only a few stray points follow them.
constexpr float kLeastAgreement = 0.7F;
constexpr std::uint32_t kStrayPoints = 10;
constexpr double kFarthestEdgeSpacings = 3.0;

// Whether the normals of two points agree across a chord, and how certain that is.
bool make_edge(const ZOrderedCloud& points, std::span<const Eigen::Vector3f> normals,
               std::uint32_t from, std::uint32_t to, Edge& edge) {
  const Eigen::Vector3f chord =
      (points.positions()[to] - points.positions()[from]).normalized().cast<float>();
  const float rise_from = normals[from].dot(chord);
  const float rise_to = normals[to].dot(chord);
  if (std::abs(rise_from) > kSteepestChord || std::abs(rise_to) > kSteepestChord) {
    return false;
  }
  const float agreement = normals[to].dot(normals[from] - 2.0F * rise_from * chord);
  const float steepness = 0.5F * std::abs(rise_from * rise_to);
  edge = {1.0F - std::abs(agreement) + steepness, from, to, agreement < 0.0F,
          std::abs(agreement) < kLeastAgreement};
  return true;
}

std::vector<Edge> neighbour_graph(const ZOrderedCloud& points,
                                  std::span<const Eigen::Vector3f> normals, double spacing) {
  const double farthest = kFarthestEdgeSpacings * spacing;
  std::vector<std::array<std::uint32_t, kGraphNeighbours>> nearest(points.size());
  tbb::parallel_for(
      tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(points.size()), 256),
      [&](auto range) {
        std::vector<Neighbour> found;
        for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
          points.find_nearest(points.positions()[i], kGraphNeighbours + 1, 2.3 * spacing, found);
          nearest[i].fill(i);
          std::size_t count = 0;
          for (const Neighbour& n : found) {
            if (n.index != i && count < kGraphNeighbours &&
                n.squared_distance <= farthest * farthest) {
              nearest[i][count++] = n.index;
            }
          }
        }
      });
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (const std::uint32_t j : nearest[i]) {
      // An edge that both ends list is made by the lower one.
      const bool listed_by_lower =
          j < i && std::find(nearest[j].begin(), nearest[j].end(), i) != nearest[j].end();
      Edge edge{};
      if (j != i && !listed_by_lower && make_edge(points, normals, i, j, edge)) {
        edges.push_back(edge);
      }
    }
  }
  tbb::parallel_sort(edges.begin(), edges.end());
  return edges;
}

// Union-find whose members know their sign relative to the root.
class SignedSets {
 public:
  explicit SignedSets(const std::vector<bool>& fixed, std::size_t size)
      : parent_(size), members_(size, 1), flipped_(size, 0), fixed_(size, 0) {
    for (std::uint32_t i = 0; i < size; ++i) {
      parent_[i] = i;
      fixed_[i] = !fixed.empty() && fixed[i] ? 1 : 0;
    }
  }

  struct Place {
    std::uint32_t root;
    bool flipped;
  };
  [[nodiscard]] Place find(std::uint32_t i) {
    std::uint32_t root = i;
    std::uint8_t flipped = 0;
    while (parent_[root] != root) {
      flipped ^= flipped_[root];
      root = parent_[root];
    }
    const Place place{root, flipped != 0};
    while (parent_[i] != root) {  // point all on the way straight to the root
      const std::uint32_t next = parent_[i];
      const std::uint8_t own = flipped_[i];
      parent_[i] = root;
      flipped_[i] = flipped;
      flipped ^= own;
      i = next;
    }
    return place;
  }

  // Joins two sets, unless the signs of both are fixed already, or both have a side of their own
  // and the edge cannot tell how they relate.
  void join(const Edge& edge) {
    const Place a = find(edge.from);
    const Place b = find(edge.to);
    if (a.root == b.root || (fixed_[a.root] != 0 && fixed_[b.root] != 0)) {
      return;
    }
    if (edge.uncertain && members_[a.root] > kStrayPoints && members_[b.root] > kStrayPoints) {
      return;
    }
    const bool flip = a.flipped ^ b.flipped ^ edge.opposite;
    const bool a_leads = fixed_[a.root] != 0 || (fixed_[b.root] == 0 && a.root < b.root);
    const std::uint32_t root = a_leads ? a.root : b.root;
    const std::uint32_t joined = a_leads ? b.root : a.root;
    parent_[joined] = root;
    members_[root] += members_[joined];
    flipped_[joined] = flip ? 1 : 0;
  }
  [[nodiscard]] bool is_fixed(std::uint32_t root) const { return fixed_[root] != 0; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> members_;  // of a root's set
  std::vector<std::uint8_t> flipped_;
  std::vector<std::uint8_t> fixed_;
};

// Which way a piece's normals point at its extreme points in 26 directions.
class OutwardVote {
 public:
  void add(const Eigen::Vector3d& position, const Eigen::Vector3f& normal) {
    for (std::size_t k = 0; k < 27; ++k) {
      const Eigen::Vector3d direction = direction_of(k);
      const double height = direction.dot(position);
      if (height > extremes_[k].height) {
        extremes_[k] = {height, normal.cast<double>().dot(direction)};
      }
    }
    up_ += static_cast<double>(normal.z());
  }
  [[nodiscard]] bool inward() const {
    double sum = 0.0;
    for (const Extreme& extreme : extremes_) {
      sum += extreme.outward;
    }
    // An open sheet's extremes contradict each other; a closed body's agree, 26 of 26.
    return std::abs(sum) > 6.0 ? sum < 0.0 : up_ < 0.0;
  }

 private:
  struct Extreme {
    double height = -std::numeric_limits<double>::infinity();
    double outward = 0.0;
  };
  static Eigen::Vector3d direction_of(std::size_t k) {
    const Eigen::Vector3d d(static_cast<double>(k % 3) - 1.0, static_cast<double>(k / 3 % 3) - 1.0,
                            static_cast<double>(k / 9) - 1.0);
    return d.normalized();  // the middle one is 0 and votes 0
  }

  std::array<Extreme, 27> extremes_;
  double up_ = 0.0;
};

}  // namespace

std::vector<Eigen::Vector3f> estimate_normals(const ZOrderedCloud& points,
                                              const ZOrderedCloud& dense, double spacing,
                                              double dense_spacing) {
  const double in_radius =
      std::numbers::pi * std::pow(kFitSpacings * spacing / std::max(dense_spacing, 1e-300), 2);
  const auto fitted = static_cast<std::size_t>(
      std::clamp(in_radius, static_cast<double>(kLeastFitted), static_cast<double>(kMostFitted)));
  const double guess =
      1.3 * dense_spacing * std::sqrt(static_cast<double>(fitted) / std::numbers::pi);
  std::vector<Eigen::Vector3f> normals = points.normals();
  normals.resize(points.size(), Eigen::Vector3f::Zero());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](auto range) {
    std::vector<Neighbour> found;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (normals[i].isZero()) {
        dense.find_nearest(points.positions()[i], fitted, guess, found);
        normals[i] = fit_normal(dense, found);
      }
    }
  });
  return normals;
}

std::uint32_t orient_normals(const ZOrderedCloud& points, std::span<Eigen::Vector3f> normals,
                             const std::vector<bool>& fixed, double spacing) {
  SignedSets sets(fixed, points.size());
  for (const Edge& edge : neighbour_graph(points, normals, spacing)) {
    sets.join(edge);
  }
  // Members by root: one piece after the other.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const SignedSets::Place place = sets.find(i);
    members[i] = {place.root, i};
    if (place.flipped) {
      normals[i] = -normals[i];
    }
  }
  tbb::parallel_sort(members.begin(), members.end());
  std::uint32_t pieces = 0;
  for (std::size_t first = 0; first < members.size(); ++pieces) {
    OutwardVote vote;
    std::size_t last = first;
    for (; last < members.size() && members[last].first == members[first].first; ++last) {
      const std::uint32_t i = members[last].second;
      vote.add(points.positions()[i], normals[i]);
    }
    const bool turn = !sets.is_fixed(members[first].first) && vote.inward();
    for (; turn && first < last; ++first) {
      normals[members[first].second] *= -1.0F;
    }
    first = last;
  }
  return pieces;
}

}  // namespace tactree::builder
