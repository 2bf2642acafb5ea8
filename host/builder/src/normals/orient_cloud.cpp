#include "normals/orient_cloud.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <queue>

#include "geometry/disjoint_sets.hpp"
#include "normals/piece_evidence.hpp"
#include "normals/signed_graph.hpp"

namespace tactree::builder {
namespace {

constexpr double kFinestBall = 2.5;  // in spacings of a random cloud: no ball passes through it
constexpr double kFinestBallResampled = 1.3;  // in spacings of an evenly spread cloud
constexpr double kDenseAsOutput = 0.45;       // uses the dense cloud above this ratio of spacings
constexpr float kCertain = 0.75F;             // minimum certainty of the edges inside a patch
constexpr float kGivenWeight = 0.3F;  // weight of a normal of the file, compared with evidence of 1
constexpr double kStatedWeight = 4.0;   // of a viewpoint or of up, times the cosine; limited to 1
constexpr float kLeastStated = 0.2F;    // below this, the surface is seen edge-on
constexpr double kGivenIsRight = 0.97;  // minimum ratio of the evidence that agrees with the file
constexpr int kSmoothingSweeps = 6;
constexpr double kFewEvidence = 0.03;  // ratio of the points below which a component is not reached
constexpr double kFlatSheet = 0.5;     // minimum mean normal of a sheet that faces one way
constexpr std::size_t kParitySamples = 9;

struct PatchLink {
  std::uint32_t from;
  SignedLink link;
};

// Each link in the rows of both of its ends.
SignedGraph graph_of(std::size_t nodes, const std::vector<PatchLink>& both_ways) {
  SignedGraph graph;
  graph.first.assign(nodes + 1, 0);
  for (const PatchLink& l : both_ways) {
    ++graph.first[l.from + 1];
    ++graph.first[l.link.to + 1];
  }
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.links.resize(graph.first[nodes]);
  std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end() - 1);
  for (const PatchLink& l : both_ways) {
    graph.links[next[l.from]++] = l.link;
    graph.links[next[l.link.to]++] = {l.from, l.link.weight};
  }
  return graph;
}

struct Belief {
  float strength;
  std::uint32_t node;
  bool operator<(const Belief& other) const {
    return strength != other.strength ? strength < other.strength : node > other.node;
  }
};

// Determines the signs of the nodes. The node with the strongest belief is decided first and passes
// its sign on to its neighbours.
std::vector<std::int8_t> decide(std::vector<float> belief, const SignedGraph& graph) {
  const auto nodes = static_cast<std::uint32_t>(belief.size());
  std::vector<std::int8_t> sign(nodes, 0);
  std::priority_queue<Belief> queue;
  for (std::uint32_t p = 0; p < nodes; ++p) {
    if (belief[p] != 0.0F) {
      queue.push({std::abs(belief[p]), p});
    }
  }
  for (std::uint32_t seed = 0; seed < nodes || !queue.empty();) {
    if (queue.empty()) {  // nothing is known about the rest
      if (sign[seed] == 0) {
        belief[seed] = 1.0F;
        queue.push({1.0F, seed});
      }
      ++seed;
      continue;
    }
    const Belief top = queue.top();
    queue.pop();
    if (sign[top.node] != 0 || top.strength != std::abs(belief[top.node])) {
      continue;
    }
    sign[top.node] = belief[top.node] < 0.0F ? -1 : 1;
    for (const SignedLink& link : graph.of(top.node)) {
      if (sign[link.to] == 0) {
        belief[link.to] += static_cast<float>(sign[top.node]) * link.weight;
        queue.push({std::abs(belief[link.to]), link.to});
      }
    }
  }
  return sign;
}

class Orienter {
 public:
  Orienter(const OrientationInput& input, std::span<Eigen::Vector3f> normals)
      : in_(input), normals_(normals) {}

  CloudOrientation run() {
    {
      const SignedGraph graph = signed_graph(in_.points, normals_, in_.spacing);
      number_pieces(graph);
      collect_evidence();
      sign_ = decide_points(graph);
      smooth(graph);
    }
    judge_pieces();
    for (std::size_t i = 0; i < sign_.size(); ++i) {
      if (sign_[i] < 0) {
        normals_[i] = -normals_[i];
        result_.repaired += is_given(i) ? 1U : 0U;
      }
    }
    orient_enclosed();
    report();
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::size_t size() const { return in_.points.size(); }
  [[nodiscard]] const Eigen::Vector3d& position(std::size_t i) const {
    return in_.points.positions()[i];
  }
  [[nodiscard]] bool is_given(std::size_t i) const {
    return !in_.given.empty() && in_.given[i] != 0;
  }

  // Numbers the connected components of the graph, ascending by lowest point.
  void number_pieces(const SignedGraph& graph) {
    DisjointSets sets(size());
    tbb::parallel_for(0U, graph.size(), [&](std::uint32_t i) {
      for (const SignedLink& link : graph.of(i)) {
        sets.join(i, link.to);
      }
    });
    piece_.resize(size());
    for (std::uint32_t i = 0; i < size(); ++i) {
      const std::uint32_t r = sets.find(i);
      piece_[i] = r == i ? pieces_++ : piece_[r];
    }
  }

  [[nodiscard]] bool by_viewpoint() const {
    return !in_.viewpoints.empty() &&
           (in_.rule == OrientationRule::kAuto || in_.rule == OrientationRule::kViewpoint);
  }

  [[nodiscard]] const Sight* sight(std::size_t i) const {
    const std::vector<Sight>& sights = in_.points.cloud().sights;
    return sights.empty() || sights[i].toward.isZero() ? nullptr : &sights[i];
  }

  [[nodiscard]] bool all_seen() const {
    for (std::size_t i = 0; i < size(); ++i) {
      const Sight* const s = sight(i);
      if (s == nullptr || !s->sure) {
        return false;
      }
    }
    return size() > 0;
  }

  void collect_evidence() {
    hint_.assign(size(), 0.0F);
    seen_.assign(pieces_, 0);
    // No other evidence is needed if every point was seen from a known position or must face up.
    const bool one_view = (by_viewpoint() && in_.viewpoints.size() == 1) || all_seen();
    if (one_view || in_.rule == OrientationRule::kUp) {
      stated_ = one_view ? OrientationBasis::kViewpoint : OrientationBasis::kUp;
      evidence_.side.resize(size());
      evidence_.pieces.assign(pieces_, {0, 0, 0, true});
      for (std::size_t i = 0; i < size(); ++i) {
        evidence_.side[i] = stated_side(i);
      }
      return;
    }
    find_outside();
    apply_sights();
    for (std::size_t i = 0; i < size(); ++i) {
      if (is_given(i)) {
        hint_[i] = kGivenWeight;
      } else if (by_viewpoint() && evidence_.side[i] == 0.0F) {
        hint_[i] = stated_side(i);
      }
    }
  }

  // A scanner position that may be a default value of the file is used for sheets only.
  void apply_sights() {
    for (std::size_t i = 0; i < size(); ++i) {
      const Sight* const s = sight(i);
      if (s == nullptr || (!s->sure && evidence_.pieces[piece_[i]].closed)) {
        continue;
      }
      const float side = stated_side(i);
      if (std::abs(side) > kLeastStated) {
        evidence_.side[i] = side;
        ++seen_[piece_[i]];
      }
    }
  }

  // Evidence from the viewpoint or from up. Strong unless the normal is nearly perpendicular to
  // that direction.
  [[nodiscard]] float stated_side(std::size_t i) const {
    const double cosine = in_.rule == OrientationRule::kUp ? static_cast<double>(normals_[i].z())
                                                           : cosine_to_viewpoint(i);
    return static_cast<float>(std::clamp(kStatedWeight * cosine, -1.0, 1.0));
  }

  void find_outside() {
    const bool use_dense = in_.dense.size() > 0 && needs_dense(in_.dense_spacing, in_.spacing);
    const double finest =
        use_dense ? kFinestBall * in_.dense_spacing
                  : std::max(kFinestBallResampled * in_.spacing, kFinestBall * in_.dense_spacing);
    evidence_ = find_evidence(in_.points.positions(), normals_, piece_, pieces_,
                              (use_dense ? in_.dense : in_.points).positions(), finest);
  }

  // Joins points of certain relative sign to patches, then determines the signs of the patches.
  std::vector<std::int8_t> decide_points(const SignedGraph& graph) {
    const Patches patches = certain_patches(graph, evidence_.side, kCertain);
    std::vector<PatchLink> between;
    for (std::uint32_t i = 0; i < size(); ++i) {
      for (const SignedLink& link : graph.of(i)) {
        const std::uint32_t a = patches.of_point[i];
        const std::uint32_t b = patches.of_point[link.to];
        if (a != b) {
          const bool opposite = patches.reversed[i] != patches.reversed[link.to];
          between.push_back({a, {b, opposite ? -link.weight : link.weight}});
        }
      }
    }
    std::vector<float> belief(patches.count, 0.0F);
    for (std::size_t i = 0; i < size(); ++i) {
      const float own = evidence_.side[i] + hint_[i];
      belief[patches.of_point[i]] += patches.reversed[i] != 0 ? -own : own;
    }
    const std::vector<std::int8_t> of_patch =
        decide(std::move(belief), graph_of(patches.count, between));
    std::vector<std::int8_t> sign(size());
    for (std::size_t i = 0; i < size(); ++i) {
      const std::int8_t s = of_patch[patches.of_point[i]];
      sign[i] = static_cast<std::int8_t>(patches.reversed[i] != 0 ? -s : s);
    }
    return sign;
  }

  // Gives points the sign of most of their neighbours, unless their own evidence is stronger.
  void smooth(const SignedGraph& graph) {
    const SignedGraph others = transposed(graph);
    contested_.assign(size(), 0);
    for (int sweep = 0; sweep < kSmoothingSweeps; ++sweep) {
      bool changed = false;
      for (std::uint32_t i = 0; i < size(); ++i) {
        float field = evidence_.side[i] + hint_[i];
        float most = std::abs(field);
        for (const std::span<const SignedLink> row : {graph.of(i), others.of(i)}) {
          for (const SignedLink& link : row) {
            field += link.weight * static_cast<float>(sign_[link.to]);
            most += std::abs(link.weight);
          }
        }
        const float support = field * static_cast<float>(sign_[i]);
        if (support < 0.0F) {
          sign_[i] = static_cast<std::int8_t>(-sign_[i]);
          changed = true;
        }
        contested_[i] = std::abs(support) < 0.6F * most || most < 1.0F ? 1 : 0;
      }
      if (!changed) {
        break;
      }
    }
  }

  struct Judgement {
    std::uint32_t points = 0;
    std::uint32_t agree = 0;  // with the evidence
    std::uint32_t against = 0;
    std::uint32_t given = 0;
    std::uint32_t given_agree = 0;  // with the evidence
    std::uint32_t given_against = 0;
    std::uint32_t given_kept = 0;  // by the signs found
    std::uint32_t contested = 0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Vector3d mean_normal = Eigen::Vector3d::Zero();
    double convex = 0.0;  // sum of the heights of the points over the centre, along their normals
    OrientationBasis basis = OrientationBasis::kOutside;
    double confidence = 1.0;
    bool reverse = false;    // reverse the signs found
    bool keep_file = false;  // keep the normals of the file instead
  };

  void count_points() {
    judgements_.assign(pieces_, {});
    for (std::size_t i = 0; i < size(); ++i) {
      Judgement& j = judgements_[piece_[i]];
      const float agreement = evidence_.side[i] * static_cast<float>(sign_[i]);
      ++j.points;
      j.agree += agreement > 0.0F ? 1U : 0U;
      j.against += agreement < 0.0F ? 1U : 0U;
      j.contested += contested_[i];
      j.centre += position(i);
      j.mean_normal += static_cast<double>(sign_[i]) * normals_[i].cast<double>();
      if (is_given(i)) {
        ++j.given;
        j.given_agree += evidence_.side[i] > 0.0F ? 1U : 0U;
        j.given_against += evidence_.side[i] < 0.0F ? 1U : 0U;
        j.given_kept += sign_[i] > 0 ? 1U : 0U;
      }
    }
    for (Judgement& j : judgements_) {
      j.centre /= j.points;
      j.mean_normal /= j.points;
    }
    for (std::size_t i = 0; i < size(); ++i) {
      Judgement& j = judgements_[piece_[i]];
      j.convex +=
          static_cast<double>(sign_[i]) * normals_[i].cast<double>().dot(position(i) - j.centre);
    }
  }

  // Cosine of the angle between the normal and the direction to the scanner. Of several viewpoints,
  // uses the one with the maximum absolute cosine.
  [[nodiscard]] double cosine_to_viewpoint(std::size_t i) const {
    if (const Sight* const s = sight(i)) {
      return static_cast<double>(normals_[i].dot(s->toward));
    }
    double best = 0.0;
    for (const Eigen::Vector3d& viewpoint : in_.viewpoints) {
      const double cosine = normals_[i].cast<double>().dot((viewpoint - position(i)).normalized());
      best = std::abs(cosine) > std::abs(best) ? cosine : best;
    }
    return best;
  }

  void judge_pieces() {
    count_points();
    for (std::uint32_t p = 0; p < pieces_; ++p) {
      Judgement& j = judgements_[p];
      const PieceEvidence& e = evidence_.pieces[p];
      const bool seen = 2 * seen_[p] > j.points;
      const bool sheet = !e.settled && !by_viewpoint() && !seen;
      const std::uint32_t tested = j.agree + j.against;
      j.confidence = 1.0 - static_cast<double>(j.contested) / j.points;
      const bool no_evidence = tested <= kFewEvidence * j.points;
      if (sheet || (stated_ && no_evidence)) {
        judge_sheet(j);
      } else if (no_evidence) {
        j.basis = OrientationBasis::kEnclosed;
      } else {
        j.basis =
            stated_.value_or(seen ? OrientationBasis::kViewpoint : OrientationBasis::kOutside);
        j.confidence = std::min(j.confidence, static_cast<double>(j.agree) / tested);
        j.keep_file = is_right_file(j);
      }
    }
    for (std::size_t i = 0; i < size(); ++i) {
      const Judgement& j = judgements_[piece_[i]];
      if (j.reverse) {
        sign_[i] = static_cast<std::int8_t>(-sign_[i]);
      } else if (j.keep_file && is_given(i)) {
        sign_[i] = 1;
      }
    }
  }

  // True if the evidence confirms the normals of the file. They are then kept also at single points
  // that contradict it.
  static bool is_right_file(const Judgement& j) {
    const std::uint32_t tested = j.given_agree + j.given_against;
    return tested != 0 && j.given_agree >= kGivenIsRight * tested;
  }

  void judge_sheet(Judgement& j) const {
    if (j.given > kFewEvidence * j.points / 3.0) {
      j.basis = OrientationBasis::kGiven;
      const double kept = static_cast<double>(j.given_kept) / j.given;
      j.reverse = kept < 0.5;
      j.confidence = std::min(j.confidence, 2.0 * std::abs(kept - 0.5));
    } else if (in_.rule == OrientationRule::kOutward || j.mean_normal.norm() < kFlatSheet) {
      j.basis = OrientationBasis::kConvex;
      j.reverse = j.convex < 0.0;
      j.confidence = std::min(j.confidence, 0.6);
    } else {
      // Up is the axis that most of the sheet faces.
      Eigen::Index axis = 2;
      if (in_.rule != OrientationRule::kUp) {
        j.mean_normal.cwiseAbs().maxCoeff(&axis);
        j.confidence = std::min(j.confidence, 0.5);
      }
      j.basis = OrientationBasis::kUp;
      j.reverse = j.mean_normal[axis] < 0.0;
    }
  }

  // Starts with the outermost component. Normals point away from the material around a cavity.
  void orient_enclosed() {
    std::vector<std::uint32_t> order;
    std::vector<Box> boxes(pieces_);
    for (std::size_t i = 0; i < size(); ++i) {
      boxes[piece_[i]].extend(position(i));
    }
    std::vector<std::vector<std::uint32_t>> members(pieces_);
    for (std::uint32_t i = 0; i < size(); ++i) {
      if (judgements_[piece_[i]].basis == OrientationBasis::kEnclosed) {
        members[piece_[i]].push_back(i);
      }
    }
    for (std::uint32_t p = 0; p < pieces_; ++p) {
      if (!members[p].empty()) {
        order.push_back(p);
      }
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double da = boxes[a].diagonal().norm();
      const double db = boxes[b].diagonal().norm();
      return da != db ? da > db : a < b;
    });
    for (const std::uint32_t p : order) {
      orient_hollow(p, members[p]);
    }
  }

  void orient_hollow(std::uint32_t p, const std::vector<std::uint32_t>& members) {
    Judgement& j = judgements_[p];
    const std::size_t samples = members.size() < 50 ? 1 : kParitySamples;
    std::vector<double> around;
    for (std::size_t k = 0; k < samples; ++k) {
      around.push_back(winding_number(position(members[k * members.size() / samples]),
                                      in_.points.positions(), normals_, piece_, p,
                                      in_.spacing * in_.spacing));
    }
    std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(samples / 2),
                     around.end());
    const bool in_material = around[samples / 2] > 0.5;
    double volume = 0.0;
    for (const std::uint32_t i : members) {
      volume += normals_[i].cast<double>().dot(position(i) - j.centre);
    }
    const bool outward = volume > 0.0;
    if (outward == in_material) {
      for (const std::uint32_t i : members) {
        normals_[i] = -normals_[i];
      }
    }
  }

  void report() {
    result_.doubtful.resize(size());
    for (std::size_t i = 0; i < size(); ++i) {
      result_.doubtful[i] = judgements_[piece_[i]].confidence < kLeastConfidence ? 1 : 0;
    }
    for (const Judgement& j : judgements_) {
      result_.pieces.push_back({j.points, j.centre, j.basis, j.confidence});
    }
    std::stable_sort(
        result_.pieces.begin(), result_.pieces.end(),
        [](const OrientedPiece& a, const OrientedPiece& b) { return a.points > b.points; });
  }

  const OrientationInput& in_;
  std::span<Eigen::Vector3f> normals_;
  std::vector<std::uint32_t> piece_;  // component of each point
  std::uint32_t pieces_ = 0;
  Evidence evidence_;
  std::vector<std::uint32_t> seen_;  // per component: points with a known position of the scanner
  std::vector<float> hint_;          // per point: evidence of the file or of a viewpoint
  std::optional<OrientationBasis> stated_;
  std::vector<std::int8_t> sign_;
  std::vector<std::uint8_t> contested_;
  std::vector<Judgement> judgements_;
  CloudOrientation result_;
};

}  // namespace

std::string_view describe(OrientationBasis basis) {
  switch (basis) {
    case OrientationBasis::kOutside:
      return "reached from one side only";
    case OrientationBasis::kEnclosed:
      return "in a hollow";
    case OrientationBasis::kViewpoint:
      return "seen from the viewpoint";
    case OrientationBasis::kGiven:
      return "as in the file";
    case OrientationBasis::kUp:
      return "a sheet, turned up";
    case OrientationBasis::kConvex:
      return "a sheet, turned to its convex side";
  }
  return "";
}

bool needs_dense(double dense_spacing, double spacing) {
  return dense_spacing > kDenseAsOutput * spacing;
}

CloudOrientation orient_cloud(const OrientationInput& input, std::span<Eigen::Vector3f> normals) {
  return Orienter(input, normals).run();
}

}  // namespace tactree::builder
