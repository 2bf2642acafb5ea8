#include "up_hint.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/cloud.hpp"

namespace tactree::builder {
namespace {

constexpr float kLevelCosine = 0.996F;       // 5 degrees
constexpr double kDepthSpacings = 1.5;       // maximum distance from the end of the box
constexpr double kDepthOfEdge = 0.005;       // or this, in lengths of its longest edge
constexpr double kOpenDepthOfEdge = 0.04;    // of the middle of an opening; edge along the axis
constexpr double kPointSpacings2 = 0.87;     // area per point, in squares of the spacing
constexpr double kMinShare = 0.04;           // minimum ratio of the points that lie on the base
constexpr double kMaxShare = 0.6;            // above: a plate, whose base is no evidence
constexpr double kTimesTheNext = 3.0;        // the base / that at any other end
constexpr double kStandShare = 0.01;         // minimum ratio of the points on which a body stands
constexpr double kStandSpread = 0.15;        // their standard deviation along x and y / that edge
constexpr double kTimesLonger = 1.25;        // the longest edge / the others
constexpr double kShellDepth = 0.8;          // minimum depth of a shell / its largest edge
constexpr std::size_t kMinHintPoints = 500;  // of fewer points, 4 % are noise

/// Of low x, y, z, high x, y, z.
using Ends = std::array<double, 6>;

std::size_t largest(const Ends& ends) {
  return static_cast<std::size_t>(std::max_element(ends.begin(), ends.end()) - ends.begin());
}

/// The points that lie flat at the ends of the box.
class FlatEnds {
 public:
  /// `both_sides`: also those that face inwards.
  FlatEnds(const Box& box, double spacing, bool both_sides)
      : box_(box),
        both_sides_(both_sides),
        depth_(std::max(kDepthSpacings * spacing, kDepthOfEdge * largest_edge(box))) {}

  void add(const Eigen::Vector3d& position, const Eigen::Vector3f& normal) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      const float up = both_sides_ ? std::abs(normal[axis]) : normal[axis];
      const float down = both_sides_ ? up : -up;
      const bool is_low = down > kLevelCosine && position[axis] - box_.min()[axis] <= depth_;
      const bool is_high = up > kLevelCosine && box_.max()[axis] - position[axis] <= depth_;
      points_[at] += is_low ? 1.0 : 0.0;
      points_[at + 3] += is_high ? 1.0 : 0.0;
      if (axis == 2 && is_low) {
        const Eigen::Vector3d from_middle = position - box_.center();
        sum_ += from_middle;
        squares_ += from_middle.cwiseAbs2();
      }
    }
  }

  [[nodiscard]] const Ends& points() const { return points_; }

  [[nodiscard]] bool stands(std::size_t count) const {
    if (points_[2] < kStandShare * static_cast<double>(count)) {
      return false;
    }
    const Eigen::Vector3d mean = sum_ / points_[2];
    const Eigen::Vector3d variance = squares_ / points_[2] - mean.cwiseAbs2();
    const Eigen::Vector3d least = (kStandSpread * box_.sizes()).cwiseAbs2();
    return variance.x() > least.x() && variance.y() > least.y();
  }

 private:
  Box box_;
  bool both_sides_;
  double depth_;
  Ends points_{};
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();  // over the points at the lowest z
  Eigen::Vector3d squares_ = Eigen::Vector3d::Zero();
};

/// Distance of a place from each end of the box, in lengths of its edges.
Ends distances(const Box& box, const Eigen::Vector3d& place) {
  Ends ends{};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double edge = std::max(box.sizes()[axis], 1e-12);
    ends[static_cast<std::size_t>(axis)] = (place[axis] - box.min()[axis]) / edge;
    ends[static_cast<std::size_t>(axis) + 3] = (box.max()[axis] - place[axis]) / edge;
  }
  return ends;
}

/// The points that would fill the openings at the ends of the box.
Ends open_points(std::span<const Opening> openings, const Box& box, double spacing) {
  const double per_area = 1.0 / (kPointSpacings2 * spacing * spacing);
  Ends points{};
  for (const Opening& opening : openings) {
    const Ends away = distances(box, opening.centre);
    const auto nearest =
        static_cast<std::size_t>(std::min_element(away.begin(), away.end()) - away.begin());
    if (away[nearest] <= kOpenDepthOfEdge) {
      points[nearest] +=
          per_area * 0.25 * std::numbers::pi * opening.diameter_m * opening.diameter_m;
    }
  }
  const Eigen::Vector3d size = box.sizes();
  for (std::size_t end = 0; end < points.size(); ++end) {
    const auto axis = static_cast<Eigen::Index>(end % 3);
    points[end] = std::min(points[end], per_area * size[(axis + 1) % 3] * size[(axis + 2) % 3]);
  }
  return points;
}

constexpr std::array<UpAxis, 3> kAxes = {UpAxis::kX, UpAxis::kY, UpAxis::kZ};

/// The end whose base is much larger than all others.
std::optional<Posture> base_at_end(const Ends& flat, const Ends& open, double count) {
  Ends base{};
  for (std::size_t end = 0; end < base.size(); ++end) {
    base[end] = flat[end] + open[end];
  }
  const std::size_t best = largest(base);
  const double points = base[best];
  const double share = points / (count + open[best]);
  base[best] = 0.0;
  if (share < kMinShare || share > kMaxShare || points < kTimesTheNext * base[largest(base)]) {
    return std::nullopt;
  }
  return Posture{kAxes[best % 3], open[best] > flat[best] ? UpEvidence::kOpen : UpEvidence::kFlat,
                 best >= 3, share};
}

std::optional<Posture> clearly_longest(const Box& box) {
  Eigen::Index longest = 0;
  const double length = box.sizes().maxCoeff(&longest);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis != longest && length <= kTimesLonger * box.sizes()[axis]) {
      return std::nullopt;
    }
  }
  return Posture{kAxes[static_cast<std::size_t>(longest)], UpEvidence::kLongest};
}

bool is_deep_opening(const Posture& posture, const Box& box) {
  const double depth = box.sizes()[static_cast<Eigen::Index>(posture.up)];
  return posture.evidence == UpEvidence::kOpen && depth >= kShellDepth * largest_edge(box);
}

std::string base_of(const Posture& posture) {
  return posture.evidence == UpEvidence::kOpen
             ? "the opening of its base"
             : fmt::format("its flat base, {:.0f} % of the surface,", 100.0 * posture.share);
}

}  // namespace

std::optional<Posture> lying_posture(std::span<const Eigen::Vector3d> positions,
                                     std::span<const Eigen::Vector3f> normals,
                                     std::span<const Opening> openings, double spacing,
                                     bool is_shell) {
  if (positions.size() < kMinHintPoints || normals.size() != positions.size()) {
    return std::nullopt;
  }
  const Box box = bounds_of(positions);
  FlatEnds flat(box, spacing, is_shell);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    flat.add(positions[i], normals[i]);
  }
  if (flat.stands(positions.size())) {
    return std::nullopt;
  }
  const auto count = static_cast<double>(positions.size());
  const Ends open = open_points(openings, box, spacing);
  std::optional<Posture> posture = base_at_end(flat.points(), open, count);
  if (is_shell && posture && !is_deep_opening(*posture, box)) {
    return std::nullopt;
  }
  if (!posture && !is_shell && open[2] < kMinShare * count) {
    posture = clearly_longest(box);
  }
  return posture && posture->up != UpAxis::kZ ? posture : std::nullopt;
}

char letter_of(UpAxis axis) { return "xyz"[static_cast<std::size_t>(axis)]; }

std::string describe_lying(const Posture& posture) {
  const char axis = letter_of(posture.up);
  if (posture.evidence == UpEvidence::kLongest) {
    return fmt::format("the model may lie on its side: it is longest along {}", axis);
  }
  return fmt::format("the model seems to lie on its side: {} is at its {} {}", base_of(posture),
                     posture.is_high ? "highest" : "lowest", axis);
}

std::string describe_turn(const Posture& posture) {
  const char axis = letter_of(posture.up);
  if (posture.evidence == UpEvidence::kLongest) {
    return fmt::format("if that is up, --axis {} turns it", axis);
  }
  if (posture.is_high) {
    return fmt::format("--axis {} sets {} upright, with this base on top; --pose turns it over",
                       axis, axis);
  }
  return fmt::format("--axis {} turns it", axis);
}

}  // namespace tactree::builder
