#include "scan_slides.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "errors.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/evaluation/shapes.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kMaxSlideDepth_m = 1e-3;  // of the hand below the surface, at most a spacing
constexpr double kFastest_m = 1e-4;        // movement per tick, at most a fifth of a spacing
constexpr double kStepsOfDepth = 20;       // of the descent to that depth
constexpr int kTicks = 300;                // per slide
constexpr int kTriesPerSlide = 20;         // for a start at which the surface fit is valid
constexpr double kCrossings_m_s[] = {0.1, 0.5, 1.0};
constexpr double kNoticed_m = 1e-3;     // maximum depth at which a crossing is noticed
constexpr int kLateTicks = 2;           // beyond, in which it is noticed late
constexpr double kSpacingsAhead = 2.0;  // of a crossing's start before the surface

struct ScanSpot {
  Vector3d point;
  Vector3d normal;
};

std::optional<ScanSpot> surface_at(const core::BlobView& view, const Vector3d& near) {
  const core::SurfaceProjection found = core::project_to_surface(view, narrow(near));
  return found.supported ? std::optional<ScanSpot>({widen(found.point), widen(found.normal)})
                         : std::nullopt;
}

/// The hand on its way over the surface.
class Slide {
 public:
  Slide(const core::BlobView& view, const ScanSpot& begin, double depth_m)
      : view_(view),
        at_(begin),
        depth_m_(depth_m),
        hand_(begin.point + depth_m * begin.normal),
        touch_(view, core::RenderMode::kSurface, hand_) {
    for (double lift = 1.0; lift > -1.0; lift -= 1.0 / kStepsOfDepth) {
      last_force_ = touch_.to(at_.point + lift * depth_m_ * at_.normal).force;
    }
    hand_ = at_.point - depth_m_ * at_.normal;
  }

  /// One tick. Returns false at the end of the surface: at a hole, an edge of a sheet, or a fold.
  bool go_on(Vector3d& direction, double step_m, SlideScores& scores) {
    const std::optional<ScanSpot> next = surface_at(view_, at_.point + step_m * direction);
    if (!next || (next->point - at_.point).norm() > 3.0 * step_m) {
      return false;
    }
    const Vector3d hand = next->point - depth_m_ * next->normal;
    const Touched touched = touch_.to(hand);
    const double moved_N = kStiffness_N_m * (hand - hand_).norm();
    ++scores.ticks;
    scores.lost += touched.in_contact ? 0 : 1;
    scores.force_max_N = std::max(scores.force_max_N, touched.force.norm());
    steps_.push_back(std::max(0.0, (touched.force - last_force_).norm() - moved_N));
    error_.add(touched.force.norm() - kStiffness_N_m * depth_m_);
    last_force_ = touched.force;
    hand_ = hand;
    at_ = *next;
    direction = (direction - direction.dot(at_.normal) * at_.normal).normalized();
    return true;
  }
  [[nodiscard]] const Errors& error() const { return error_; }
  [[nodiscard]] const std::vector<double>& steps() const { return steps_; }

 private:
  const core::BlobView& view_;
  ScanSpot at_;
  double depth_m_;
  Vector3d hand_;
  Touch touch_;
  Vector3d last_force_ = Vector3d::Zero();
  Errors error_;
  std::vector<double> steps_;  // change of the force in each tick, N
};

enum class Crossing { kFromInside, kNoticed, kLate, kMissed };

/// Moves straight through the surface by `step_m` per tick.
Crossing cross(const core::BlobView& view, const ScanSpot& spot, double step_m, double phase) {
  const double ahead = kSpacingsAhead * static_cast<double>(view.header().spacing_m);
  const auto at = [&](double depth) { return (spot.point - depth * spot.normal).eval(); };
  Touch touch(view, core::RenderMode::kSurface, at(-ahead));
  touch.to(at(-ahead));
  if (touch.to(at(-ahead)).inside) {  // known from the second tick on
    return Crossing::kFromInside;
  }
  int late = 0;
  for (double depth = phase * step_m - ahead; late < kLateTicks; depth += step_m) {
    late += depth > kNoticed_m ? 1 : 0;
    if (touch.to(at(depth)).in_contact) {
      return late == 0 ? Crossing::kNoticed : Crossing::kLate;
    }
  }
  return Crossing::kMissed;
}

}  // namespace

SlideScores slide_over(const core::BlobView& view, std::span<const Vector3d> points, int slides,
                       std::uint32_t seed) {
  SlideScores scores;
  const auto spacing = static_cast<double>(view.header().spacing_m);
  const double depth_m = std::min(kMaxSlideDepth_m, spacing);
  const double step_m = std::min(kFastest_m, 0.2 * spacing);
  scores.expected_N = kStiffness_N_m * depth_m;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, points.size() - 1);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> steps;
  double sum_squared = 0.0;
  for (int tries = 0; tries < kTriesPerSlide * slides && scores.slides < slides; ++tries) {
    const std::optional<ScanSpot> begin = surface_at(view, points[pick(random)]);
    const double x = any(random);
    const double y = any(random);
    const Vector3d aim(x, y, any(random));
    if (!begin) {
      continue;
    }
    Vector3d direction = (aim - aim.dot(begin->normal) * begin->normal).normalized();
    Slide slide(view, *begin, depth_m);
    for (int tick = 0; tick < kTicks && slide.go_on(direction, step_m, scores); ++tick) {
    }
    if (slide.error().count() > 0) {
      ++scores.slides;
      sum_squared += std::pow(slide.error().rms(), 2) * static_cast<double>(slide.error().count());
      steps.insert(steps.end(), slide.steps().begin(), slide.steps().end());
    }
    for (const double speed : kCrossings_m_s) {
      const Crossing crossing = cross(view, *begin, speed * kPeriodS, unit(random));
      scores.crossings += crossing != Crossing::kFromInside ? 1 : 0;
      scores.late += crossing == Crossing::kLate ? 1 : 0;
      scores.missed += crossing == Crossing::kMissed ? 1 : 0;
    }
  }
  scores.force_error_rms_N =
      scores.ticks == 0 ? kNotMeasured : std::sqrt(sum_squared / scores.ticks);
  scores.force_step_99_N = quantile(steps, 0.99);
  scores.force_step_999_N = quantile(steps, 0.999);
  scores.force_step_N = quantile(steps, 1.0);
  return scores;
}

}  // namespace tactree::evaluation
