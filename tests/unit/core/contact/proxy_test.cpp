// The god-object: contact is never missed, never lost, and the force turns and grows smoothly.

#include "tactree/core/contact/proxy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "analytic_shapes.hpp"

namespace tactree::test {
namespace {

constexpr double kPeriod = 1e-3;     // s
constexpr double kStiffness = 1000;  // N/m
constexpr core::Friction kSmooth{0.0F, 0.0F};

/// Moves a new proxy along a path, one tick per call.
class Walk {
 public:
  explicit Walk(const Shape& shape) : view_(shape.view()) {}

  /// The force, N: stiffness times the displacement of the proxy; zero when free.
  Eigen::Vector3d to(const Eigen::Vector3d& probe, const core::Friction& friction = kSmooth) {
    if (first_) {
      proxy_.reset(narrow(probe));
      first_ = false;
    }
    proxy_.update(view_, narrow(probe), friction, core::work_per_tick(1000.0F));
    if (!proxy_.in_contact()) {
      return Eigen::Vector3d::Zero();
    }
    return kStiffness * static_cast<double>(proxy_.strength()) *
           (widen(proxy_.position()) - widen(narrow(probe)));
  }
  [[nodiscard]] const core::Proxy& proxy() const { return proxy_; }

 private:
  const core::BlobView& view_;
  core::Proxy proxy_;
  bool first_ = true;
};

/// Moves straight in at `speed` to `depth` below the surface. True: the proxy detected contact.
bool notices_crossing(const Shape& shape, const Eigen::Vector3d& entry,
                      const Eigen::Vector3d& inward, double speed, double phase, double depth) {
  Walk walk(shape);
  const double step = speed * kPeriod;
  for (double s = -0.02 + phase * step; s < depth + step; s += step) {
    walk.to(entry + s * inward);
    if (walk.proxy().in_contact()) {
      return true;
    }
  }
  // A probe faster than the sweep: the proxy follows with a delay.
  for (int i = 0; i < 50 && !walk.proxy().in_contact(); ++i) {
    walk.to(entry + depth * inward);
  }
  return walk.proxy().in_contact();
}

int crossings_missed(
    const Shape& shape,
    const std::function<void(std::mt19937&, Eigen::Vector3d&, Eigen::Vector3d&)>& random_entry) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int missed = 0;
  for (const double speed : {0.05, 0.2, 1.0, 2.0, 4.0, 5.0, 6.0}) {
    for (int i = 0; i < 200; ++i) {
      Eigen::Vector3d entry;
      Eigen::Vector3d inward;
      random_entry(random, entry, inward);
      missed += notices_crossing(shape, entry, inward, speed, unit(random), 0.01) ? 0 : 1;
    }
  }
  return missed;
}

/// A direction within 60 degrees of `axis`.
Eigen::Vector3d slanted(std::mt19937& random, const Eigen::Vector3d& axis) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  while (true) {
    const Eigen::Vector3d d =
        Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    if (d.dot(axis) > 0.5) {
      return d;
    }
  }
}

TEST(Proxy, DetectsEverySphereCrossing) {
  const Shape shape = sphere();
  EXPECT_EQ(0, crossings_missed(shape, [](std::mt19937& random, Eigen::Vector3d& entry,
                                          Eigen::Vector3d& inward) {
              std::uniform_real_distribution<double> unit(-1.0, 1.0);
              const Eigen::Vector3d d =
                  Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
              entry = kSphereRadius * d;
              inward = slanted(random, -d);
            }));
}

TEST(Proxy, DetectsEverySheetCrossing) {
  const CosSheet sheet;
  const Shape shape = cos_sheet(sheet);
  EXPECT_EQ(0, crossings_missed(shape, [&sheet](std::mt19937& random, Eigen::Vector3d& entry,
                                                Eigen::Vector3d& inward) {
              std::uniform_real_distribution<double> unit(-1.0, 1.0);
              const double x = 0.015 * unit(random);
              const double y = 0.015 * unit(random);
              entry = sheet.point(x, y);
              inward =
                  slanted(random, unit(random) < 0.0 ? sheet.normal(x, y) : -sheet.normal(x, y));
            }));
}

TEST(Proxy, DetectsEveryThinPlateCrossing) {
  const Shape shape = plate(0.5 * kSpacing, 0.04);
  EXPECT_EQ(0, crossings_missed(shape, [](std::mt19937& random, Eigen::Vector3d& entry,
                                          Eigen::Vector3d& inward) {
              std::uniform_real_distribution<double> unit(-1.0, 1.0);
              const double side = unit(random) < 0.0 ? -1.0 : 1.0;
              entry = {0.01 * unit(random), 0.01 * unit(random), side * 0.25 * kSpacing};
              inward = slanted(random, {0.0, 0.0, -side});
            }));
}

TEST(Proxy, NeverPullsThroughPlate) {
  const Shape shape = plate(0.5 * kSpacing);
  Walk walk(shape);
  walk.to({0.0, 0.0, -0.01});
  for (int i = 0; i < 20; ++i) {
    walk.to({0.0, 0.0, -0.01});
  }
  EXPECT_FALSE(walk.proxy().in_contact());
}

TEST(Proxy, StaysOnTouchedPlateSide) {
  const Shape shape = plate(0.5 * kSpacing);
  Walk walk(shape);
  for (double z = 0.005; z > -0.004; z -= 2e-5) {
    const Eigen::Vector3d force = walk.to({1e-3, 2e-3, z});
    if (z < 0.2e-3) {
      ASSERT_TRUE(walk.proxy().in_contact()) << z;
      ASSERT_NEAR(force.z(), kStiffness * (0.25e-3 - z), 0.01) << z;
    }
  }
}

TEST(Proxy, RepelsOnTouchedSide) {
  const Shape shape = plane();
  for (const double side : {-1.0, 1.0}) {
    Walk walk(shape);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (double z = 0.005; z > -0.001; z -= 5e-5) {
      force = walk.to({1e-3, 2e-3, side * z});
    }
    EXPECT_NEAR(force.z(), side * 1.0, 0.06);
    EXPECT_NEAR(static_cast<double>(walk.proxy().normal().z), side, 1e-3);
  }
}

/// Slides 1 mm deep and says how the force behaves.
struct Slide {
  double largest_step = 0.0;  // N from one tick to the next
  double error_rms = 0.0;     // N against 1 N along the true normal
  int lost = 0;               // ticks without contact
};

Slide slide(const Shape& shape, const std::function<Eigen::Vector3d(double)>& surface_point,
            const std::function<Eigen::Vector3d(double)>& normal, double ticks,
            const core::Friction& friction) {
  constexpr double kDepth = 1e-3;
  Walk walk(shape);
  for (double lift = 0.004; lift > -kDepth; lift -= 5e-5) {
    walk.to(surface_point(0.0) + lift * normal(0.0), friction);
  }
  Slide result;
  Eigen::Vector3d last = walk.to(surface_point(0.0) - kDepth * normal(0.0), friction);
  double sum = 0.0;
  for (double tick = 1.0; tick <= ticks; tick += 1.0) {
    const Eigen::Vector3d force = walk.to(surface_point(tick) - kDepth * normal(tick), friction);
    result.lost += walk.proxy().in_contact() ? 0 : 1;
    result.largest_step = std::max(result.largest_step, (force - last).norm());
    sum += (force - kStiffness * kDepth * normal(tick)).squaredNorm();
    last = force;
  }
  result.error_rms = std::sqrt(sum / ticks);
  return result;
}

TEST(Proxy, SlidesSmoothlyOverSheet) {
  const CosSheet sheet;
  const Shape shape = cos_sheet(sheet);
  // 0.1 m/s along a line in a general direction.
  const auto x = [](double tick) { return -0.030 + tick * 0.9e-4; };
  const auto y = [](double tick) { return -0.012 + tick * 0.4359e-4; };
  const Slide result = slide(
      shape, [&](double t) { return sheet.point(x(t), y(t)); },
      [&](double t) { return sheet.normal(x(t), y(t)); }, 600, kSmooth);
  EXPECT_EQ(result.lost, 0);
  // 1 N that turns with the sheet changes by up to 0.0028 N a tick; the rest is roughness.
  EXPECT_LE(result.largest_step, 0.005);
  EXPECT_GE(result.largest_step, 0.0005);
  EXPECT_LE(result.error_rms, 0.005);
}

TEST(Proxy, SlidesSmoothlyOverSphere) {
  const Shape shape = sphere();
  const auto direction = [](double tick) {
    const double a = tick * 1e-4 / kSphereRadius;
    return Eigen::Vector3d(std::sin(a) * 0.8, std::sin(a) * 0.6, std::cos(a));
  };
  const Slide result = slide(
      shape, [&](double t) { return Eigen::Vector3d(kSphereRadius * direction(t)); }, direction,
      1800, kSmooth);
  EXPECT_EQ(result.lost, 0);
  EXPECT_LE(result.largest_step, 0.005);  // the turn alone: 0.0033 N
  EXPECT_GE(result.largest_step, 0.0033);
  EXPECT_LE(result.error_rms, 0.005);
}

TEST(Proxy, FadesForceBeyondBoundary) {
  const double half = 0.01;
  const Shape shape = plane(half);
  Walk walk(shape);
  for (double z = 0.004; z > -1e-3; z -= 5e-5) {
    walk.to({0.0, 0.3e-3, z});
  }
  Eigen::Vector3d last = walk.to({0.0, 0.3e-3, -1e-3});
  EXPECT_NEAR(last.z(), 1.0, 0.01);
  double largest_step = 0.0;
  for (double x = 0.0; x < half + 0.005; x += 1e-4) {
    const Eigen::Vector3d force = walk.to({x, 0.3e-3, -1e-3});
    largest_step = std::max(largest_step, (force - last).norm());
    last = force;
  }
  EXPECT_FALSE(walk.proxy().in_contact());
  EXPECT_EQ(last.norm(), 0.0);
  EXPECT_LE(largest_step, 0.25);  // a snap would be 1 N
  // Coming back below the sheet is not a contact from above.
  for (double x = half + 0.005; x > 0.0; x -= 1e-4) {
    ASSERT_EQ(walk.to({x, 0.3e-3, -1e-3}).norm(), 0.0) << x;
  }
}

/// Two sheets of a scan near one another: a lower one, z = 0, which ends at x = end_m, and an upper
/// one, which begins above x = 0.
struct Junction {
  double height_m;
  double tilt_rad;  // of the upper sheet about y: it rises with x
  double end_m;
};

Shape sheets_of(const Junction& junction, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-0.3, 0.3);
  const auto place = [&](int i) { return (i + 0.5 + unit(random)) * kSpacing; };
  const Eigen::Vector3d rise(std::cos(junction.tilt_rad), 0.0, std::sin(junction.tilt_rad));
  const Eigen::Vector3d normal(-rise.z(), 0.0, rise.x());
  Shape shape;
  for (int i = -24; i < 24; ++i) {
    for (int j = -16; j < 16; ++j) {
      const double y = place(j);
      if (const double x = place(i); x < junction.end_m) {
        shape.add({x, y, 0.0}, Eigen::Vector3d::UnitZ());
      }
      if (const double along = place(i); along > 0.0) {
        shape.add(along * rise + Eigen::Vector3d(0.0, y, junction.height_m), normal);
      }
    }
  }
  shape.seal();
  return shape;
}

/// Moves onto the lower sheet, to `depth_m` below it and under the upper one. Returns how far the
/// proxy stays behind the place on the upper sheet that is closest to the probe.
double lag_behind(const Junction& junction, const Shape& shape, double depth_m) {
  Walk walk(shape);
  Eigen::Vector3d probe(-0.008, 0.3e-3, 0.003);
  for (; probe.z() > -depth_m; probe.z() -= 1e-4) {
    walk.to(probe);
  }
  for (; probe.x() < 0.006; probe.x() += 1e-4) {
    walk.to(probe);
  }
  for (int i = 0; i < 200; ++i) {
    walk.to(probe);
  }
  EXPECT_TRUE(walk.proxy().in_contact());
  const double along = probe.x() * std::cos(junction.tilt_rad) +
                       (probe.z() - junction.height_m) * std::sin(junction.tilt_rad);
  const double closest = std::max(0.0, along) * std::cos(junction.tilt_rad);
  return closest - static_cast<double>(walk.proxy().position().x);
}

// Where a step of any length leads onto the other sheet, and away from the probe.
TEST(Proxy, PassesFromSheetToSheet) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Junction junction{(0.3 + 0.7 * unit(random)) * kSpacing, 0.3 * unit(random),
                            3.0 * unit(random) * kSpacing};
    const double depth_m = 3e-4 + 4e-3 * unit(random);
    EXPECT_LE(lag_behind(junction, sheets_of(junction, random), depth_m), 1e-3)
        << "height " << junction.height_m << " tilt " << junction.tilt_rad << " end "
        << junction.end_m << " depth " << depth_m;
  }
}

TEST(Proxy, EndsContactAtSurface) {
  const Shape shape = plane();
  Walk walk(shape);
  for (double z = 0.002; z > -1e-3; z -= 5e-5) {
    walk.to({0.0, 0.0, z});
  }
  for (double z = -1e-3; z < 2e-3; z += 5e-5) {
    const Eigen::Vector3d force = walk.to({0.0, 0.0, z});
    ASSERT_GE(force.z(), 0.0);  // never pulls
    ASSERT_EQ(walk.proxy().in_contact(), z < 4e-6) << z;
  }
}

}  // namespace
}  // namespace tactree::test
