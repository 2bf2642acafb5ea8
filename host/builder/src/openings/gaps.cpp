#include "openings/gaps.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "geometry/disjoint_sets.hpp"
#include "geometry/local_points.hpp"

namespace tactree::builder {
namespace {

constexpr double kNeighbourSpacings = 1.7;
constexpr double kBorderAngle = 2.0 * std::numbers::pi / 3.0;
// A point whose normal has a smaller cosine belongs to the other side of a plate.
constexpr float kOtherSideCosine = -0.3F;
// Minimum cosine to the axis of a wedge for a point in its central part (30 degrees).
constexpr double kWedgeCosine = 0.866;
// Limits for a surface that turns at an edge: the cosine between the normals, and the cosine of the
// other normal to the axis of the wedge.
constexpr float kBentCosine = 0.75F;
constexpr double kBentAwayCosine = 0.5;
constexpr double kBehindSpacings = 0.3;
constexpr double kGoesOnSpacings = 1.0;
// Distance of an empty ball from the point beside it.
constexpr double kBesideSpacings = 0.85;
// Border points belong to one opening if they are close to each other and their `away` directions
// agree, or if the points at the look distance into the opening are close to each other. The latter
// joins opposite sides of a small hole. Distances in support radii.
constexpr double kNearRadii = 1.0;
constexpr double kSameDirectionCosine = 0.3;
constexpr double kLookRadii = 0.4;
constexpr double kSameLookRadii = 0.6;
// A border point sees across its opening within 45 degrees of the axis of its wedge.
constexpr double kAcrossCosine = 0.707;
// Fraction of border points that must see the other side of their opening to classify it as a hole.
constexpr double kHolePart = 0.5;
constexpr std::size_t kLooks = 64;
constexpr double kBridgedRadii = kBridgedSpacings / kSupportSpacings;
// An opening is wide if a slightly wider ball is empty: a border point touches it.
constexpr double kWideRadii = 1.01 * kBridgedRadii;
// Minimum number of border points per spacing of diameter; fewer are noise.
constexpr double kLeastPointsPerSpacing = 1.0;
constexpr std::size_t kLeastPoints = 6;  // of a hole wider than the radius, and of any edge

struct TangentFrame {
  Eigen::Vector3d u;
  Eigen::Vector3d v;
};

TangentFrame tangents_of(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
  return {u, normal.cross(u)};
}

// The widest angle between adjacent directions, and the direction of its bisector.
struct Wedge {
  double angle = 2.0 * std::numbers::pi;
  double middle = 0.0;
};

Wedge widest_wedge(std::vector<double>& directions) {
  if (directions.empty()) {
    return {};
  }
  std::sort(directions.begin(), directions.end());
  Wedge widest{0.0, 0.0};
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const bool last = i + 1 == directions.size();
    const double next = last ? directions.front() + 2.0 * std::numbers::pi : directions[i + 1];
    if (next - directions[i] > widest.angle) {
      widest = {next - directions[i], 0.5 * (next + directions[i])};
    }
  }
  return widest;
}

// Classification of single points.
class PointProbe {
 public:
  PointProbe(const ZOrderedCloud& points, double spacing, double radius)
      : points_(points), spacing_(spacing), radius_(radius) {}

  /// Distance up to which a probe looks.
  [[nodiscard]] double reach() const {
    return std::max(kNeighbourSpacings * spacing_, radius_ + kBesideSpacings * spacing_);
  }

  // True for a border point. Otherwise `gap` is the diameter of an empty ball beside the point.
  // `local` holds the points within reach of the point.
  bool is_border(LocalPoints& local, std::uint32_t i, Eigen::Vector3d& away, double& gap) {
    local_ = &local;
    const Eigen::Vector3d& p = points_.positions()[i];
    gather(i);
    // In the plane of the mean normal both faces of an edge are visible.
    const TangentFrame frame = tangents_of(mean_normal_);
    directions_.clear();
    for (const std::uint32_t j : near_) {
      const Eigen::Vector3d d = points_.positions()[j] - p;
      directions_.push_back(std::atan2(d.dot(frame.v), d.dot(frame.u)));
    }
    const Wedge wedge = widest_wedge(directions_);
    away = std::cos(wedge.middle) * frame.u + std::sin(wedge.middle) * frame.v;
    if (wedge.angle > kBorderAngle && !wedge_holds_point(i, away)) {
      gap = 0.0;
      return !turns_at(i, away);
    }
    gap = empty_ball(p + kBesideSpacings * spacing_ * away);
    return false;
  }

 private:
  // Collects the neighbours on this side of the body and their mean normal.
  void gather(std::uint32_t i) {
    const Eigen::Vector3f& normal = points_.normals()[i];
    Eigen::Vector3f sum = normal;
    near_.clear();
    local_->visit_within(points_.positions()[i], kNeighbourSpacings * spacing_,
                         [&](std::uint32_t j, double) {
                           if (j != i && normal.dot(points_.normals()[j]) > kOtherSideCosine) {
                             near_.push_back(j);
                             sum += points_.normals()[j];
                           }
                         });
    mean_normal_ = (sum.norm() > 0.1F ? sum : normal).cast<double>().normalized();
  }

  [[nodiscard]] bool wedge_holds_point(std::uint32_t i, const Eigen::Vector3d& away) const {
    const Eigen::Vector3d& p = points_.positions()[i];
    bool found = false;
    local_->visit_within(p, radius_, [&](std::uint32_t j, double squared) {
      const double along = (points_.positions()[j] - p).dot(away);
      found = found || (along > 0.0 && along * along > kWedgeCosine * kWedgeCosine * squared &&
                        points_.normals()[i].dot(points_.normals()[j]) > kOtherSideCosine);
    });
    return found;
  }

  // True if the surface continues around an edge: in another direction, or on the other side of a
  // plate that ends here as well.
  [[nodiscard]] bool turns_at(std::uint32_t i, const Eigen::Vector3d& away) const {
    const Eigen::Vector3d& p = points_.positions()[i];
    const Eigen::Vector3f& normal = points_.normals()[i];
    bool bends = false;
    bool other_side = false;
    bool other_side_goes_on = false;
    local_->visit_within(p, radius_, [&](std::uint32_t j, double) {
      const Eigen::Vector3f& other = points_.normals()[j];
      const float cosine = normal.dot(other);
      const double along = (points_.positions()[j] - p).dot(away);
      if (cosine <= kOtherSideCosine) {
        other_side = true;
        other_side_goes_on = other_side_goes_on || along > kGoesOnSpacings * spacing_;
      } else if (cosine < kBentCosine && along > -kBehindSpacings * spacing_) {
        bends = bends || std::abs(other.cast<double>().dot(away)) > kBentAwayCosine;
      }
    });
    return bends || (other_side && !other_side_goes_on);
  }

  [[nodiscard]] double empty_ball(const Eigen::Vector3d& centre) const {
    double least = radius_ * radius_;
    local_->visit_within(centre, radius_,
                         [&](std::uint32_t, double squared) { least = std::min(least, squared); });
    return 2.0 * std::sqrt(least);
  }

  const ZOrderedCloud& points_;
  double spacing_;
  double radius_;
  LocalPoints* local_ = nullptr;
  std::vector<std::uint32_t> near_;
  Eigen::Vector3d mean_normal_ = Eigen::Vector3d::UnitZ();
  std::vector<double> directions_;
};

// Groups the border points by opening. The normals of `border` are the directions away from the
// surface.
std::map<std::uint32_t, std::vector<std::uint32_t>> group(const ZOrderedCloud& border,
                                                          double radius) {
  const auto count = static_cast<std::uint32_t>(border.size());
  DisjointSets sets(count);
  const auto look = [&](std::uint32_t i) -> Eigen::Vector3d {
    return border.positions()[i] + kLookRadii * radius * border.normals()[i].cast<double>();
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const double farthest = (2.0 * kLookRadii + kSameLookRadii) * radius;
    border.visit_within(border.positions()[i], farthest, [&](std::uint32_t j, double squared) {
      const bool same_edge =
          squared <= kNearRadii * kNearRadii * radius * radius &&
          static_cast<double>(border.normals()[i].dot(border.normals()[j])) > kSameDirectionCosine;
      if (same_edge || (look(i) - look(j)).norm() < kSameLookRadii * radius) {
        sets.join(i, j);
      }
    });
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < count; ++i) {
    groups[sets.find(i)].push_back(i);
  }
  return groups;
}

/// Border points, and the surface that they belong to.
struct Border {
  ZOrderedCloud points;               // the normals are the directions away from the surface
  std::vector<std::uint32_t> of_all;  // number of each in `all`
  const ZOrderedCloud& all;
};

std::uint32_t farthest_from(const ZOrderedCloud& border, const std::vector<std::uint32_t>& members,
                            const Eigen::Vector3d& place) {
  return *std::max_element(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
    return (border.positions()[a] - place).squaredNorm() <
           (border.positions()[b] - place).squaredNorm();
  });
}

// True if two border points face each other across an opening. The normals of `border` are the
// directions away from the surface.
bool see_each_other(const ZOrderedCloud& border, std::uint32_t i, std::uint32_t j) {
  const Eigen::Vector3d chord = border.positions()[j] - border.positions()[i];
  const double cosine = kAcrossCosine * chord.norm();
  return border.normals()[i].cast<double>().dot(chord) > cosine &&
         border.normals()[j].cast<double>().dot(-chord) > cosine;
}

// True if most border points face another border point across the opening.
bool is_hole(const ZOrderedCloud& border, const std::vector<std::uint32_t>& members) {
  const std::size_t stride = 1 + (members.size() - 1) / kLooks;
  std::size_t looks = 0;
  std::size_t met = 0;
  for (std::size_t k = 0; k < members.size(); k += stride, ++looks) {
    const std::uint32_t i = members[k];
    met += std::any_of(members.begin(), members.end(),
                       [&](std::uint32_t j) { return see_each_other(border, i, j); })
               ? 1U
               : 0U;
  }
  return static_cast<double>(met) > kHolePart * static_cast<double>(looks);
}

// Diameter of the ball around `centre`, up to `most`, without points of the side of the body that
// border point `i` is on.
double empty_ball(const Border& border, std::uint32_t i, const Eigen::Vector3d& centre,
                  double most) {
  const Eigen::Vector3f& normal = border.all.normals()[border.of_all[i]];
  double squared = 0.25 * most * most;
  border.all.visit_within(centre, 0.5 * most, [&](std::uint32_t j, double its) {
    if (its < squared && normal.dot(border.all.normals()[j]) > kOtherSideCosine) {
      squared = its;
    }
  });
  return 2.0 * std::sqrt(squared);
}

// Width of a hole: diameter of the widest empty ball midway between two border points that face
// each other. From each point, the nearest one that it sees finds the width of a crack, and the
// farthest one that of a round hole.
double width_of_hole(const Border& border, const std::vector<std::uint32_t>& members) {
  const std::vector<Eigen::Vector3d>& positions = border.points.positions();
  const std::size_t stride = 1 + (members.size() - 1) / kLooks;
  double widest = 0.0;
  for (std::size_t k = 0; k < members.size(); k += stride) {
    const std::uint32_t i = members[k];
    std::optional<Neighbour> nearest;
    std::optional<Neighbour> farthest;
    for (const std::uint32_t j : members) {
      if (see_each_other(border.points, i, j)) {
        const Neighbour seen{(positions[j] - positions[i]).squaredNorm(), j};
        nearest = nearest ? std::min(*nearest, seen) : seen;
        farthest = farthest ? std::max(*farthest, seen) : seen;
      }
    }
    for (const std::optional<Neighbour>& other : {nearest, farthest}) {
      if (other && other->squared_distance > widest * widest) {
        const Eigen::Vector3d middle = 0.5 * (positions[i] + positions[other->index]);
        widest =
            std::max(widest, empty_ball(border, i, middle, std::sqrt(other->squared_distance)));
      }
    }
  }
  return widest;
}

// Diameter, up to `most`, of the widest empty ball that touches a border point from outside.
double width_beyond(const Border& border, const std::vector<std::uint32_t>& members, double most) {
  const std::size_t stride = 1 + (members.size() - 1) / kLooks;
  double widest = 0.0;
  for (std::size_t k = 0; k < members.size(); k += stride) {
    const std::uint32_t i = members[k];
    const Eigen::Vector3d beyond =
        border.points.positions()[i] + 0.5 * most * border.points.normals()[i].cast<double>();
    widest = std::max(widest, empty_ball(border, i, beyond, most));
  }
  return widest;
}

Opening measure(const Border& border, const std::vector<std::uint32_t>& members) {
  const std::vector<Eigen::Vector3d>& positions = border.points.positions();
  Opening opening;
  opening.points = static_cast<std::uint32_t>(members.size());
  for (const std::uint32_t i : members) {
    opening.centre += positions[i];
  }
  opening.centre /= static_cast<double>(members.size());
  if (is_hole(border.points, members)) {
    opening.kind = Opening::Kind::kHole;
    opening.diameter_m = width_of_hole(border, members);
  } else {
    opening.kind = Opening::Kind::kBoundary;
    const std::uint32_t one = farthest_from(border.points, members, opening.centre);
    const std::uint32_t other = farthest_from(border.points, members, positions[one]);
    opening.diameter_m = (positions[one] - positions[other]).norm();
  }
  return opening;
}

struct Probed {
  std::vector<Eigen::Vector3f> away;  // for border points; 0 for others
  std::vector<float> gap;             // for points that are not at a border
};

Probed probe_all(const ZOrderedCloud& points, double spacing, double radius) {
  const auto count = static_cast<std::uint32_t>(points.size());
  Probed probed{std::vector<Eigen::Vector3f>(count, Eigen::Vector3f::Zero()),
                std::vector<float>(count, 0.0F)};
  const PointProbe blank(points, spacing, radius);
  tbb::enumerable_thread_specific<PointProbe> probes(blank);
  for_each_with_local(points, points, blank.reach(), [&](LocalPoints& local, std::uint32_t i) {
    Eigen::Vector3d direction;
    double width = 0.0;
    if (probes.local().is_border(local, i, direction, width)) {
      probed.away[i] = direction.cast<float>();
    }
    probed.gap[i] = static_cast<float>(width);
  });
  return probed;
}

}  // namespace

std::vector<Eigen::Vector3f> border_directions(const ZOrderedCloud& points, double spacing,
                                               double radius) {
  return probe_all(points, spacing, radius).away;
}

Gaps find_gaps(const ZOrderedCloud& points, double spacing, double radius, bool watertight) {
  const auto count = static_cast<std::uint32_t>(points.size());
  const auto [away, gap] = probe_all(points, spacing, radius);
  std::vector<std::uint32_t> at_border;
  std::vector<Eigen::Vector3f> directions;
  Gaps gaps;
  for (std::uint32_t i = 0; i < count; ++i) {
    gaps.largest_m = std::max(gaps.largest_m, static_cast<double>(gap[i]));
    if (!away[i].isZero()) {
      at_border.push_back(i);
      directions.push_back(away[i]);
    }
  }
  if (watertight) {
    return gaps;
  }
  Border border{points.subset(at_border), std::move(at_border), points};
  border.points.set_normals(std::move(directions));
  for (const auto& [root, members] : group(border.points, radius)) {
    const Opening opening = measure(border, members);
    if (members.size() < kLeastPoints || static_cast<double>(members.size()) * spacing <
                                             kLeastPointsPerSpacing * opening.diameter_m) {
      continue;
    }
    double width = opening.diameter_m;
    if (opening.kind == Opening::Kind::kHole) {
      gaps.largest_m = std::max(gaps.largest_m, width);
    } else {
      width = std::min(width, width_beyond(border, members, kWideRadii * radius));
    }
    if (width > kBridgedRadii * radius) {
      gaps.openings.push_back(opening);
    }
  }
  std::stable_sort(gaps.openings.begin(), gaps.openings.end(),
                   [](const Opening& a, const Opening& b) { return a.diameter_m > b.diameter_m; });
  return gaps;
}

}  // namespace tactree::builder
