#include <algorithm>

#include "errors.hpp"
#include "measurements.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/surface.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kDepth = 1e-3;    // m, of the slides
constexpr double kPerTick = 1e-4;  // m; 0.1 m/s at 1 kHz
constexpr double kLift = 4e-3;     // m, start above the surface
constexpr double kDescent = 5e-5;  // m per tick
constexpr double kSlipped = 2e-3;  // m, travel after which friction is dynamic
constexpr core::Friction kRough{0.4F, 0.3F};

const core::BlobView& blob_of(const Subject& subject, Mode mode) {
  return mode == kPaper ? subject.paper.view() : subject.shape.view();
}

core::RenderMode render_mode(Mode mode) {
  return mode == kPaper ? core::RenderMode::kPaper : core::RenderMode::kSurface;
}

/// Surface point, normal and distance computed by a mode.
struct Projected {
  bool found = false;
  Vector3d point = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
  double distance = 0.0;  // signed
};

Projected ask_surface(const core::BlobView& view, const Vector3d& probe) {
  const core::SurfaceProjection p = core::project_to_surface(view, narrow(probe));
  return {p.supported, widen(p.point), widen(p.normal), static_cast<double>(p.signed_distance)};
}

/// Distances in paper mode have no sign; it is taken from the true distance.
Projected ask_paper(const core::BlobView& view, const Vector3d& probe, double true_distance) {
  const core::PaperContact contact = core::paper_collision(view, narrow(probe));
  const core::NearestPoint nearest = core::paper_nearest(view, narrow(probe), contact);
  if (!contact.in_contact || !nearest.found()) {
    return {};
  }
  const Vector3d offset = probe - widen(nearest.position);
  const double outward = true_distance < 0.0 ? -1.0 : 1.0;
  return {true, widen(nearest.position), outward * offset, outward * offset.norm()};
}

void score_distances(const Subject& subject, Mode mode, int probes, Random& random,
                     Scores& scores) {
  const double h = subject.spacing_m();
  std::uniform_real_distribution<double> height(-subject.probe_depth_m * h / kSpacing, h);
  Errors distance;
  Errors depth;
  Errors normal;
  for (int i = 0; i < probes; ++i) {
    const Spot spot = subject.spot(random);
    const Vector3d probe = spot.point + height(random) * spot.normal;
    const double truth = subject.distance(probe);
    const Projected answer = mode == kPaper ? ask_paper(blob_of(subject, mode), probe, truth)
                                            : ask_surface(blob_of(subject, mode), probe);
    if (!answer.found) {
      continue;
    }
    distance.add(subject.distance(answer.point));
    depth.add(answer.distance - truth);
    normal.add(angle_deg(answer.normal, subject.normal(answer.point, answer.normal)));
  }
  scores.set("distance_rms_m", distance.rms());
  scores.set("distance_max_m", distance.largest());
  scores.set("depth_rms_m", depth.rms());
  scores.set("normal_rms_deg", normal.rms());
  scores.set("normal_max_deg", normal.largest());
  scores.set("answered", static_cast<double>(distance.count()) / probes);
}

/// Descends onto the start of a path, to 1 mm below the surface.
Touch touch_down(const Subject& subject, Mode mode, const Path& path,
                 const core::Friction& friction) {
  const Spot begin = path.spot(0.0);
  Touch touch(blob_of(subject, mode), render_mode(mode), begin.point + kLift * begin.normal,
              friction);
  for (double lift = kLift; lift > -kDepth; lift -= kDescent) {
    touch.to(begin.point + lift * begin.normal);
  }
  return touch;
}

/// Calls each(s, spot, touched) for every tick of a slide, starting with s = 0.
template <class Each>
void slide(const Subject& subject, Mode mode, const Path& path, const core::Friction& friction,
           const Each& each) {
  Touch touch = touch_down(subject, mode, path, friction);
  for (double i = 0.0; i * kPerTick <= path.length_m; i += 1.0) {
    const Spot spot = path.spot(i * kPerTick);
    each(i * kPerTick, spot, touch.to(spot.point - kDepth * spot.normal));
  }
}

void score_slides(const Subject& subject, Mode mode, Scores& scores) {
  Errors error;
  double largest_step = 0.0;
  int lost = 0;
  for (const Path& path : subject.paths) {
    Vector3d last = Vector3d::Zero();
    slide(subject, mode, path, {}, [&](double s, const Spot& spot, const Touched& touched) {
      error.add((touched.force - kStiffness_N_m * kDepth * spot.normal).norm());
      largest_step = std::max(largest_step, s > 0.0 ? (touched.force - last).norm() : 0.0);
      lost += touched.in_contact ? 0 : 1;
      last = touched.force;
    });
  }
  scores.set("force_error_rms_N", error.rms());
  scores.set("force_step_max_N", largest_step);
  scores.set("contact_lost", lost);
  scores.set("slide_ticks", static_cast<double>(error.count()));
}

void score_sticky(const Subject& subject, Mode mode, int probes, Random& random, Scores& scores) {
  constexpr double kOutside = 1e-3;
  int pulled = 0;
  for (int i = 0; i < probes; ++i) {
    const Spot spot = subject.spot(random);
    Touch touch(blob_of(subject, mode), render_mode(mode), spot.point + kLift * spot.normal);
    Touched touched;
    for (double lift = kLift; lift > kOutside - 0.5 * kDescent; lift -= kDescent) {
      touched = touch.to(spot.point + lift * spot.normal);
    }
    pulled += touched.force.dot(spot.normal) < -1e-6 ? 1 : 0;
  }
  scores.set("sticky", static_cast<double>(pulled) / probes);
}

/// A random direction within 60 degrees of `axis`.
Vector3d slanted(Random& random, const Vector3d& axis) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  while (true) {
    const double x = unit(random);
    const double y = unit(random);
    const Vector3d d = Vector3d(x, y, unit(random)).normalized();
    if (d.dot(axis) > 0.5) {
      return d;
    }
  }
}

/// Moves straight through the surface at `entry`, from 20 mm before it to 10 mm behind it. Returns
/// true if this causes contact.
bool notices_crossing(const Subject& subject, Mode mode, const Vector3d& entry,
                      const Vector3d& inward, double step, double phase) {
  constexpr double kBefore = 0.02;
  constexpr double kBehind = 0.01;
  Touch touch(blob_of(subject, mode), render_mode(mode), entry - kBefore * inward);
  for (double s = (phase - 1.0) * step - kBefore; s < kBehind + step; s += step) {
    if (touch.to(entry + s * inward).in_contact) {
      return true;
    }
  }
  // The sweep may lag behind a fast probe, so that contact begins some ticks later.
  bool noticed = false;
  for (int i = 0; i < 50 && !noticed; ++i) {
    noticed = touch.to(entry + kBehind * inward).in_contact;
  }
  return noticed;
}

void score_crossings(const Subject& subject, Mode mode, int each, Random& random, Scores& scores) {
  if (!subject.crossings) {
    return;
  }
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int missed = 0;
  int tried = 0;
  for (const double speed : {0.05, 0.2, 1.0, 2.0, 4.0, 5.0, 6.0}) {
    for (int i = 0; i < each; ++i) {
      Spot spot = subject.spot(random);
      while (std::max(std::abs(spot.point.x()), std::abs(spot.point.y())) > 0.015 &&
             subject.distance(Vector3d::Zero()) > -0.02) {
        spot = subject.spot(random);  // keep away from the boundary of a sheet
      }
      const Vector3d inward = slanted(random, -spot.normal);
      missed += notices_crossing(subject, mode, spot.point, inward, speed * kPeriodS, unit(random))
                    ? 0
                    : 1;
      ++tried;
    }
  }
  scores.set("crossings_missed", missed);
  scores.set("crossings", tried);
}

void score_friction(const Subject& subject, Mode mode, Scores& scores) {
  if (!subject.friction || mode == kPaper) {
    return;  // paper mode has no friction
  }
  double low = 1e9;
  double high = 0.0;
  for (const Path& path : subject.paths) {
    slide(subject, mode, path, kRough, [&](double s, const Spot&, const Touched& touched) {
      if (s < kSlipped) {
        return;
      }
      const Vector3d normal = subject.normal(touched.proxy, touched.force);
      const double push = touched.force.dot(normal);
      const double ratio = (touched.force - push * normal).norm() / std::abs(push);
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    });
  }
  scores.set("friction_min", low);
  scores.set("friction_max", high);
}

}  // namespace

Scores score_shape(const Subject& subject, Mode mode, const Effort& effort, std::uint32_t seed) {
  Random random(seed);  // the same probes for both modes
  Scores scores;
  score_distances(subject, mode, effort.probes, random, scores);
  score_slides(subject, mode, scores);
  score_sticky(subject, mode, effort.sticky, random, scores);
  score_crossings(subject, mode, effort.crossings, random, scores);
  score_friction(subject, mode, scores);
  return scores;
}

ForceTrace trace_force(const Subject& subject) {
  ForceTrace trace;
  trace.title = subject.title;
  for (const Mode mode : {kSurface, kPaper}) {
    slide(subject, mode, subject.paths.front(), {},
          [&](double s, const Spot&, const Touched& touched) {
            if (mode == kSurface) {
              trace.distance_m.push_back(s);
            }
            trace.force_N[mode].push_back(touched.force.norm());
          });
  }
  return trace;
}

}  // namespace tactree::evaluation
