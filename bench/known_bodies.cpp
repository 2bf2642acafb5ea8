#include "known_bodies.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

namespace tactree::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kTurn = 2.0 * std::numbers::pi;

// Uniform numbers in [0, 1), the same on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed * 0x9E3779B97F4A7C15U + 1) {}
  double operator()() { return std::ldexp(static_cast<double>(generator_() >> 11), -53); }
  double gauss() {  // Box and Muller
    const double radius = std::sqrt(-2.0 * std::log(1.0 - (*this)()));
    return radius * std::cos(kTurn * (*this)());
  }
  Vector3d direction() {
    const double z = 2.0 * (*this)() - 1.0;
    const double angle = kTurn * (*this)();
    const double ring = std::sqrt(1.0 - z * z);
    return {ring * std::cos(angle), ring * std::sin(angle), z};
  }

 private:
  std::mt19937_64 generator_;
};

/// A part of a body: a closed surface that can be sampled, and its interior.
struct Part {
  std::function<void(Random&, std::size_t, KnownCloud&)> sample;
  std::function<bool(const Vector3d&)> inside;
  double area = 0.0;
};

void add(KnownCloud& cloud, const Vector3d& position, const Vector3d& normal) {
  cloud.positions.push_back(position);
  cloud.normals.push_back(normal.normalized());
}

// The surface of the union of the parts.
KnownCloud union_of(const std::string& name, const std::vector<Part>& parts, std::uint64_t seed) {
  KnownCloud cloud;
  cloud.name = name;
  Random random(seed + 17);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    KnownCloud own;
    parts[k].sample(random, static_cast<std::size_t>(std::lround(parts[k].area)), own);
    for (std::size_t i = 0; i < own.positions.size(); ++i) {
      bool covered = false;
      for (std::size_t other = 0; other < parts.size(); ++other) {
        covered = covered || (other != k && parts[other].inside(own.positions[i]));
      }
      if (!covered) {
        add(cloud, own.positions[i], own.normals[i]);
      }
    }
  }
  return cloud;
}

double ellipsoid_area(const Vector3d& half) {  // Thomsen's formula, within 1.1 %
  constexpr double kP = 1.6075;
  const Vector3d q = half.array().pow(kP);
  return 2.0 * kTurn * std::pow((q.x() * q.y() + q.y() * q.z() + q.z() * q.x()) / 3.0, 1.0 / kP);
}

Part ellipsoid(const Vector3d& centre, const Vector3d& half,
               const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  Part part;
  part.area = ellipsoid_area(half);
  const double most = 1.0 / half.minCoeff();
  part.sample = [=](Random& random, std::size_t count, KnownCloud& cloud) {
    for (std::size_t i = 0; i < count;) {
      const Vector3d unit = random.direction();
      const Vector3d gradient = unit.cwiseQuotient(half);
      if (random() * most < gradient.norm()) {  // the area element of the map from the sphere
        add(cloud, centre + turn * unit.cwiseProduct(half), turn * gradient);
        ++i;
      }
    }
  };
  part.inside = [=](const Vector3d& p) {
    return (turn.transpose() * (p - centre)).cwiseQuotient(half).squaredNorm() < 1.0;
  };
  return part;
}

/// A tube around a curve, with round ends if it is open.
Part tube(const std::vector<Vector3d>& curve, double radius, bool closed) {
  const std::size_t n = curve.size();
  const std::size_t links = closed ? n : n - 1;
  std::vector<double> until = {0.0};
  for (std::size_t k = 0; k < links; ++k) {
    until.push_back(until.back() + (curve[(k + 1) % n] - curve[k]).norm());
  }
  const auto nearest = [=](const Vector3d& p) {
    Vector3d best = curve[0];
    for (std::size_t k = 0; k < links; ++k) {
      const Vector3d along = curve[(k + 1) % n] - curve[k];
      const double t = std::clamp((p - curve[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const Vector3d at = curve[k] + t * along;
      best = (at - p).squaredNorm() < (best - p).squaredNorm() ? at : best;
    }
    return best;
  };
  Part part;
  part.area = kTurn * radius * until.back() + (closed ? 0.0 : 2.0 * kTurn * radius * radius);
  part.inside = [=](const Vector3d& p) { return (nearest(p) - p).norm() < radius * (1.0 - 1e-6); };
  part.sample = [=](Random& random, std::size_t count, KnownCloud& cloud) {
    const double ends = closed ? 0.0 : 2.0 * radius;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = random() * (until.back() + ends);
      if (at >= until.back()) {
        const bool first = random() < 0.5;
        const Vector3d along = first ? curve[0] - curve[1] : curve[n - 1] - curve[n - 2];
        Vector3d d = random.direction();
        d = d.dot(along) < 0.0 ? Vector3d(-d) : d;
        add(cloud, (first ? curve[0] : curve[n - 1]) + radius * d, d);
        continue;
      }
      const auto above = std::upper_bound(until.begin(), until.end(), at) - until.begin();
      const auto k = static_cast<std::size_t>(above - 1);
      const Vector3d along = (curve[(k + 1) % n] - curve[k]).normalized();
      const Vector3d side = along.unitOrthogonal();
      const double angle = kTurn * random();
      const Vector3d d = std::cos(angle) * side + std::sin(angle) * along.cross(side);
      add(cloud, curve[k] + (at - until[k]) * along + radius * d, d);
    }
  };
  return part;
}

/// A polygon (counter-clockwise) extruded from -height/2 to height/2.
KnownCloud extruded(const std::string& name, const std::vector<Vector2d>& polygon, double height,
                    std::uint64_t seed) {
  KnownCloud cloud;
  cloud.name = name;
  Random random(seed + 29);
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d edge = polygon[(i + 1) % polygon.size()] - a;
    box.extend(a);
    const double wanted = edge.norm() * height + random();
    for (int k = 0; k < static_cast<int>(wanted); ++k) {
      const Vector2d p = a + random() * edge;
      add(cloud, {p.x(), p.y(), (random() - 0.5) * height}, {edge.y(), -edge.x(), 0.0});
    }
  }
  const auto inside = [&](const Vector2d& p) {
    bool odd = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
      const Vector2d& a = polygon[i];
      const Vector2d& b = polygon[j];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
        odd = !odd;
      }
    }
    return odd;
  };
  const auto tries = static_cast<std::size_t>(2.0 * box.volume());
  for (std::size_t k = 0; k < tries; ++k) {
    const Vector2d p = box.min() + Vector2d(random(), random()).cwiseProduct(box.sizes());
    if (inside(p)) {
      const double side = k % 2 == 0 ? 1.0 : -1.0;
      add(cloud, {p.x(), p.y(), 0.5 * side * height}, {0.0, 0.0, side});
    }
  }
  return cloud;
}

}  // namespace

KnownCloud twisted_arms(std::size_t points, double thin, std::uint64_t seed) {
  constexpr int kArms = 6;
  const double scale = std::sqrt(static_cast<double>(points));
  const double radius = 0.16 * scale;
  const double length = 0.55 * (static_cast<double>(points) - 2.0 * kTurn * radius * radius) /
                        (kTurn * 0.5 * thin * kArms);
  const double reach = std::min(length, 0.9 * scale);
  std::vector<Part> parts = {ellipsoid(Vector3d::Zero(), Vector3d::Constant(radius))};
  for (int arm = 0; arm < kArms; ++arm) {
    const double golden = kTurn * 0.381966 * arm;
    const double z = 1.0 - (2.0 * arm + 1.0) / kArms;
    const double ring = std::sqrt(1.0 - z * z);
    const Vector3d out(ring * std::cos(golden), ring * std::sin(golden), z);
    const Vector3d side = out.unitOrthogonal();
    std::vector<Vector3d> curve;
    constexpr int kLinks = 120;
    const double coil = 0.04 * scale;
    for (int k = 0; k <= kLinks; ++k) {
      const double t = static_cast<double>(k) / kLinks;
      const double angle = 3.0 * kTurn * t;
      curve.emplace_back((0.9 * radius + t * reach) * out +
                         coil * std::min(1.0, 4.0 * t) *
                             (std::cos(angle) * side + std::sin(angle) * out.cross(side)));
    }
    parts.push_back(tube(curve, 0.5 * thin, false));
  }
  return union_of("body with thin twisted arms", parts, seed);
}

KnownCloud long_blade(std::size_t points, double thin, std::uint64_t seed) {
  const double width = std::sqrt(static_cast<double>(points) / 2.0 / 9.0);
  KnownCloud cloud;
  cloud.name = "flat long blade";
  Random random(seed + 3);
  const double length = 9.0 * width;
  const auto twist = [&](const Vector3d& p) -> Eigen::Matrix3d {
    return Eigen::AngleAxisd(0.8 * p.x() / length, Vector3d::UnitX()).toRotationMatrix();
  };
  const std::vector<Vector2d> outline = {{-0.5 * length, -0.5 * width},
                                         {0.5 * length, -0.5 * width},
                                         {0.5 * length, 0.5 * width},
                                         {-0.5 * length, 0.5 * width}};
  KnownCloud flat = extruded(cloud.name, outline, thin, seed);
  for (std::size_t i = 0; i < flat.positions.size(); ++i) {
    const Eigen::Matrix3d turn = twist(flat.positions[i]);
    add(cloud, turn * flat.positions[i], turn * flat.normals[i]);
  }
  return cloud;
}

KnownCloud thin_gear(std::size_t points, double thin, std::uint64_t seed) {
  const double radius = std::sqrt(static_cast<double>(points) / (kTurn * 2.2));
  const double gap = 2.0 * thin + 1.0;
  const int teeth = std::max(6, static_cast<int>(kTurn * radius / (thin + gap)));
  const double depth = std::min(0.35 * radius, 6.0 * thin);
  std::vector<Vector2d> outline;
  for (int k = 0; k < teeth; ++k) {
    const double angle = kTurn * k / teeth;
    const Vector2d out(std::cos(angle), std::sin(angle));
    const Vector2d side(-out.y(), out.x());
    for (const auto& [r, s] : {std::pair(radius, -0.5), std::pair(radius + depth, -0.5),
                               std::pair(radius + depth, 0.5), std::pair(radius, 0.5)}) {
      outline.emplace_back(r * out + s * thin * side);
    }
  }
  return extruded("gear with thin teeth", outline, std::max(0.25 * radius, 2.0 * thin), seed);
}

KnownCloud head_with_ears(std::size_t points, double thin, std::uint64_t seed) {
  const double radius = std::sqrt(static_cast<double>(points) / (2.0 * kTurn * 1.4));
  std::vector<Part> parts = {ellipsoid(Vector3d::Zero(), radius * Vector3d(0.8, 0.9, 1.1))};
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.5 * side, Vector3d(0.3, 0.2, 1.0).normalized()).toRotationMatrix();
    parts.push_back(ellipsoid({0.0, side * 1.1 * radius, 0.5 * radius},
                              {0.5 * thin, 0.45 * radius, 0.6 * radius}, turn));
  }
  return union_of("head with thin ears", parts, seed);
}

KnownCloud torus_knot(std::size_t points, double thin, std::uint64_t seed) {
  constexpr int kLinks = 400;
  std::vector<Vector3d> curve;
  double length = 0.0;
  for (int k = 0; k < kLinks; ++k) {
    const double t = kTurn * k / kLinks;
    const double r = 2.0 + std::cos(3.0 * t);
    curve.emplace_back(r * std::cos(2.0 * t), r * std::sin(2.0 * t), -std::sin(3.0 * t));
    length +=
        k == 0
            ? 0.0
            : (curve[static_cast<std::size_t>(k)] - curve[static_cast<std::size_t>(k) - 1]).norm();
  }
  const double radius =
      std::max(0.5 * thin, 0.25 * std::sqrt(static_cast<double>(points) / (kTurn * length * 0.25)));
  const double scale = static_cast<double>(points) / (kTurn * radius * length);
  for (Vector3d& p : curve) {
    p *= scale;
  }
  return union_of("torus knot", {tube(curve, radius, true)}, seed);
}

KnownCloud nested_shells(std::size_t points, std::uint64_t seed) {
  const double radius = std::sqrt(static_cast<double>(points) / (2.0 * kTurn * 1.75));
  KnownCloud cloud;
  cloud.name = "nested shells";
  Random random(seed + 5);
  for (const auto& [part, sign] :
       {std::pair(1.0, 1.0), std::pair(0.7, -1.0), std::pair(0.4, 1.0)}) {
    KnownCloud shell;
    const Part ball = ellipsoid(Vector3d::Zero(), Vector3d::Constant(part * radius));
    ball.sample(random, static_cast<std::size_t>(ball.area), shell);
    for (std::size_t i = 0; i < shell.positions.size(); ++i) {
      add(cloud, shell.positions[i], sign * shell.normals[i]);
    }
  }
  return cloud;
}

KnownCloud flat_plate(std::size_t points, double thin, std::uint64_t seed) {
  const double half = 0.5 * std::sqrt(static_cast<double>(points) / 2.0);
  return extruded("flat plate", {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, thin,
                  seed);
}

KnownCloud vessel(std::size_t points, double thin, std::uint64_t seed) {
  // A profile turned around z: up the outside, over the boundary, down the inside.
  const double scale = std::sqrt(static_cast<double>(points) / 10.3);
  std::vector<Vector2d> outline;  // r, z
  constexpr int kSteps = 60;
  const auto wall = [&](double t, double inset) {
    return Vector2d(scale * (0.75 + 0.25 * std::cos(kTurn * 0.45 * t)) - inset,
                    scale * 1.2 * t + (t == 0.0 ? inset : 0.0));
  };
  outline.emplace_back(0.0, 0.0);
  for (int k = 0; k <= kSteps; ++k) {
    outline.push_back(wall(static_cast<double>(k) / kSteps, 0.0));
  }
  for (int k = kSteps; k >= 0 && wall(static_cast<double>(k) / kSteps, thin).y() > thin; --k) {
    outline.push_back(wall(static_cast<double>(k) / kSteps, thin));
  }
  outline.push_back(wall(0.0, thin));
  outline.emplace_back(0.0, thin);
  KnownCloud cloud;
  cloud.name = "vessel with a thin wall";
  Random random(seed + 7);
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const Vector2d edge = outline[k + 1] - outline[k];
    const double widest = std::max(outline[k].x(), outline[k + 1].x());
    const double wanted = kTurn * widest * edge.norm() + random();
    for (int i = 0; i < static_cast<int>(wanted); ++i) {
      const Vector2d p = outline[k] + random() * edge;
      const double angle = kTurn * random();
      if (random() * widest < p.x()) {
        add(cloud, {p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()},
            {edge.y() * std::cos(angle), edge.y() * std::sin(angle), -edge.x()});
      }
    }
  }
  return cloud;
}

KnownCloud open_figure(std::size_t points, std::uint64_t seed) {
  const double radius = std::sqrt(static_cast<double>(points) / (2.0 * kTurn * 1.9));
  const KnownCloud whole =
      union_of("figure without a base",
               {ellipsoid(Vector3d::Zero(), radius * Vector3d(0.9, 0.8, 1.3)),
                ellipsoid({0.2 * radius, 0.0, 1.5 * radius}, Vector3d::Constant(0.55 * radius)),
                ellipsoid({0.9 * radius, 0.1, 0.6 * radius}, radius * Vector3d(0.7, 0.2, 0.2)),
                ellipsoid({-0.8 * radius, 0.1, 0.2 * radius}, radius * Vector3d(0.25, 0.25, 0.8))},
               seed);
  KnownCloud cloud;
  cloud.name = whole.name;
  for (std::size_t i = 0; i < whole.positions.size(); ++i) {
    if (whole.positions[i].z() > -0.9 * radius) {
      add(cloud, whole.positions[i], whole.normals[i]);
    }
  }
  return cloud;
}

KnownCloud open_relief(std::size_t points, std::uint64_t seed) {
  const double edge = std::sqrt(static_cast<double>(points) / 1.15);
  KnownCloud cloud;
  cloud.name = "open relief";
  Random random(seed + 11);
  while (cloud.positions.size() < points) {
    const double x = (random() - 0.5) * edge;
    const double y = (random() - 0.5) * edge;
    const double k = 20.0 / edge;
    const double a = 0.04 * edge;
    const double dx = a * k * std::cos(k * x + 0.3) * std::sin(0.7 * k * y);
    const double dy = 0.7 * a * k * std::sin(k * x + 0.3) * std::cos(0.7 * k * y);
    const Vector3d normal(-dx, -dy, 1.0);
    if (random() * 1.5 < normal.norm()) {
      add(cloud, {x, y, a * std::sin(k * x + 0.3) * std::sin(0.7 * k * y)}, normal);
    }
  }
  return cloud;
}

KnownCloud seen_from(const KnownCloud& cloud, const Vector3d& viewpoint) {
  // A depth image with pixels 1.5 spacings wide at the middle of the cloud.
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : cloud.positions) {
    middle += p / static_cast<double>(cloud.positions.size());
  }
  const Vector3d forward = (middle - viewpoint).normalized();
  const double focal = (middle - viewpoint).norm() / 1.5;
  const Vector3d right = forward.unitOrthogonal();
  const Vector3d up = forward.cross(right);
  const auto pixel = [&](const Vector3d& p) {
    const Vector3d d = p - viewpoint;
    const double depth = d.dot(forward);
    return std::pair(static_cast<long>(std::floor(focal * d.dot(right) / depth)),
                     static_cast<long>(std::floor(focal * d.dot(up) / depth)));
  };
  std::map<std::pair<long, long>, double> nearest;
  for (const Vector3d& p : cloud.positions) {
    const auto [found, added] = nearest.try_emplace(pixel(p), 1e300);
    found->second = std::min(found->second, (p - viewpoint).norm());
  }
  KnownCloud seen;
  seen.name = cloud.name + ", one view";
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vector3d& p = cloud.positions[i];
    const Vector3d ray = (viewpoint - p).normalized();
    const auto [u, v] = pixel(p);
    bool hidden = cloud.normals[i].dot(ray) < 0.1;
    for (long k = 0; k < 9 && !hidden; ++k) {
      const auto found = nearest.find({u + k % 3 - 1, v + k / 3 - 1});
      hidden = found != nearest.end() && found->second < (p - viewpoint).norm() - 8.0;
    }
    if (!hidden) {
      add(seen, p, cloud.normals[i]);
    }
  }
  return seen;
}

KnownCloud merged_views(const KnownCloud& cloud, int views, double registration,
                        std::uint64_t seed) {
  KnownCloud merged;
  merged.name = cloud.name + ", merged views";
  Random random(seed + 13);
  double extent = 0.0;
  for (const Vector3d& p : cloud.positions) {
    extent = std::max(extent, p.norm());
  }
  for (int k = 0; k < views; ++k) {
    const double z = 0.8 - 1.4 * (k + 0.5) / views;  // none from below
    const double angle = 2.4 * k;
    const double ring = std::sqrt(1.0 - z * z);
    const Vector3d camera =
        3.0 * extent * Vector3d(ring * std::cos(angle), ring * std::sin(angle), z);
    const Vector3d shift = registration * random.direction();
    const KnownCloud seen = seen_from(cloud, camera);
    for (std::size_t i = 0; i < seen.positions.size(); ++i) {
      if (random() < 4.0 / views) {
        const Vector3d jitter(random.gauss(), random.gauss(), random.gauss());
        add(merged, seen.positions[i] + shift + 0.25 * jitter, seen.normals[i]);
      }
    }
  }
  return merged;
}

void rotate(KnownCloud& cloud, std::uint64_t seed) {
  if (seed == 0) {
    return;
  }
  Random random(seed);
  const Vector3d axis = random.direction();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(kTurn * random(), axis).toRotationMatrix();
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    cloud.positions[i] = turn * cloud.positions[i];
    cloud.normals[i] = turn * cloud.normals[i];
  }
}

void add_noise(KnownCloud& cloud, double spacings, std::uint64_t seed) {
  Random random(seed + 19);
  for (Vector3d& p : cloud.positions) {
    p += spacings * Vector3d(random.gauss(), random.gauss(), random.gauss());
  }
}

}  // namespace tactree::bench
