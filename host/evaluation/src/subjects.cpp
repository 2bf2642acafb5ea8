#include "subjects.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kSubjectDepth = 1e-3;  // of all slides, m
constexpr double kBoxHalf = 0.02;
constexpr double kBoxShift = 0.3;            // spacings; leaves no row parallel to an edge
constexpr double kBoxZone = 2.5 * kSpacing;  // support radius, within which an edge has influence
constexpr double kOnEdge = 0.03 * kSpacing;  // a point that is this close to two faces is on both
constexpr double kPlateThickness = 0.5 * kSpacing;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// 1 or -1 with equal probability.
double side(Random& random) { return uniform(random, -1.0, 1.0) < 0.0 ? -1.0 : 1.0; }

Subject subject(std::string name, std::string title, Shape shape) {
  Shape paper = shape.paper_twin();
  Subject made{std::move(name), std::move(title), std::move(shape), std::move(paper), {}, {}, {}};
  return made;
}

// ---- cosine sheets

/// Random chords of a disc about the centre, as seen from above.
std::vector<Path> lines_over(const CosSheet& sheet, Random& random, int count) {
  constexpr double kBoundary = 0.033;
  std::vector<Path> paths;
  while (static_cast<int>(paths.size()) < count) {
    const double from = uniform(random, 0.0, 2.0 * std::numbers::pi);
    const double to = uniform(random, 0.0, 2.0 * std::numbers::pi);
    const Vector3d begin(kBoundary * std::cos(from), kBoundary * std::sin(from), 0.0);
    const Vector3d chord =
        Vector3d(kBoundary * std::cos(to), kBoundary * std::sin(to), 0.0) - begin;
    if (chord.norm() < kBoundary) {
      continue;
    }
    const Vector3d direction = chord.normalized();
    paths.push_back({[=](double s) {
                       const Vector3d at = begin + s * direction;
                       return Spot{sheet.point(at.x(), at.y()), sheet.normal(at.x(), at.y())};
                     },
                     chord.norm()});
  }
  return paths;
}

Subject over_cos(std::string name, std::string title, Shape shape, Random& random, int lines) {
  const CosSheet sheet;
  Subject made = subject(std::move(name), std::move(title), std::move(shape));
  made.distance = [=](const Vector3d& p) {
    const Vector3d foot = sheet.nearest(p);
    return (p - foot).dot(sheet.normal(foot.x(), foot.y()));
  };
  made.normal = [=](const Vector3d& p, const Vector3d&) {
    const Vector3d foot = sheet.nearest(p);
    return sheet.normal(foot.x(), foot.y());
  };
  made.spot = [=](Random& r) {
    const double x = uniform(r, -0.033, 0.033);
    const double y = uniform(r, -0.033, 0.033);
    return Spot{sheet.point(x, y), sheet.normal(x, y)};
  };
  made.paths = lines_over(sheet, random, lines);
  made.crossings = true;
  return made;
}

/// Points of a cosine sheet, each displaced along the sheet by up to `shift` spacings, and normal
/// to it by a Gaussian error with a standard deviation of `noise` spacings. Only a fraction `kept`
/// of the points is used.
Shape uneven_cos(Random& random, double shift, double noise, double kept) {
  const CosSheet sheet;
  Shape shape;
  const int n = 40;
  std::normal_distribution<double> off(0.0, 1.0);
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      const double x = (i + uniform(random, -shift, shift)) * kSpacing;
      const double y = (j + uniform(random, -shift, shift)) * kSpacing;
      const double height = noise * kSpacing * off(random);
      if (uniform(random, 0.0, 1.0) < kept) {
        shape.add(sheet.point(x, y) + height * sheet.normal(x, y), sheet.normal(x, y));
      }
    }
  }
  shape.seal();
  return shape;
}

// ---- sphere

Subject on_sphere(std::string name, std::string title, double spacing_m, Random& random,
                  int lines) {
  Subject made = subject(std::move(name), std::move(title), sphere(kSphereRadius, spacing_m));
  made.distance = [](const Vector3d& p) { return p.norm() - kSphereRadius; };
  made.normal = [](const Vector3d& p, const Vector3d&) { return p.normalized(); };
  const auto direction = [](Random& r) {
    std::normal_distribution<double> any;
    const double x = any(r);
    const double y = any(r);
    return Vector3d(x, y, any(r)).normalized();
  };
  made.spot = [=](Random& r) {
    const Vector3d d = direction(r);
    return Spot{kSphereRadius * d, d};
  };
  for (int i = 0; i < std::max(1, lines / 4); ++i) {
    const Vector3d a = direction(random);
    const Vector3d b = a.cross(direction(random)).normalized();
    made.paths.push_back({[=](double s) {
                            const double turn = s / kSphereRadius;
                            const Vector3d d = std::cos(turn) * a + std::sin(turn) * b;
                            return Spot{kSphereRadius * d, d};
                          },
                          std::numbers::pi * kSphereRadius});
  }
  made.crossings = true;
  made.friction = true;
  return made;
}

// ---- box

double box_distance(const Vector3d& p) {
  const Vector3d beyond = p.cwiseAbs() - Vector3d::Constant(kBoxHalf);
  const double outside = beyond.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : beyond.maxCoeff();
}

Vector3d box_normal(const Vector3d& p, const Vector3d& answer) {
  Vector3d best = Vector3d::Zero();
  double highest = -2.0;
  const double nearest = (p.cwiseAbs().array() - kBoxHalf).maxCoeff();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(p[axis]) - kBoxHalf < nearest - kOnEdge) {
      continue;
    }
    const Vector3d face = std::copysign(1.0, p[axis]) * Vector3d::Unit(axis);
    if (face.dot(answer) > highest) {
      highest = face.dot(answer);
      best = face;
    }
  }
  return best;
}

/// Box with spots on its faces; `across` returns their distances from the centre of the face along
/// its axes.
Subject on_box(std::string name, std::string title,
               std::function<std::pair<double, double>(Random&)> across) {
  Subject made = subject(std::move(name), std::move(title), box(kBoxHalf, kBoxShift));
  made.distance = box_distance;
  made.normal = box_normal;
  made.spot = [across = std::move(across)](Random& r) {
    const int axis = std::uniform_int_distribution<int>(0, 2)(r);
    const Vector3d face = side(r) * Vector3d::Unit(axis);
    const auto [u, v] = across(r);
    const bool swap = side(r) < 0.0;
    Vector3d p = kBoxHalf * face;
    p[(axis + 1) % 3] = side(r) * (swap ? v : u);
    p[(axis + 2) % 3] = side(r) * (swap ? u : v);
    return Spot{p, face};
  };
  return made;
}

/// A path on the top face that ends where the probe is as near to the adjacent face as to the top.
Path to_the_edge(const Vector3d& direction, double y) {
  const double inside = kBoxHalf - kSubjectDepth;
  constexpr double kLength = 0.008;
  return {[=](double s) {
            const Vector3d end(inside, direction.y() == 0.0 ? y : inside, kBoxHalf);
            return Spot{end - (kLength - s) * direction, Vector3d::UnitZ()};
          },
          kLength};
}

double on_face(Random& r) { return uniform(r, 0.0, kBoxHalf - 2.0 * kBoxZone); }
double near_boundary(Random& r) { return uniform(r, kBoxHalf - kBoxZone, kBoxHalf); }

void add_boxes(std::vector<Subject>& all) {
  Subject face = on_box("box_face", "box, irregular points: faces", [](Random& r) {
    return std::pair{on_face(r), on_face(r)};
  });
  for (const double y : {-0.0123, 0.0031}) {
    face.paths.push_back({[=](double s) {
                            return Spot{{s - 0.015, y + 0.3 * s, kBoxHalf}, Vector3d::UnitZ()};
                          },
                          0.028});
  }
  face.friction = true;
  all.push_back(std::move(face));

  Subject edge = on_box("box_edge", "box, within R of an edge", [](Random& r) {
    return std::pair{near_boundary(r), on_face(r)};
  });
  edge.paths = {to_the_edge(Vector3d::UnitX(), 0.0031), to_the_edge(Vector3d::UnitX(), -0.00687)};
  all.push_back(std::move(edge));

  Subject corner = on_box("box_corner", "box, within R of a corner", [](Random& r) {
    return std::pair{near_boundary(r), near_boundary(r)};
  });
  corner.paths = {to_the_edge(Vector3d(1.0, 1.0, 0.0).normalized(), 0.0)};
  all.push_back(std::move(corner));
}

// ---- thin shapes

/// A path on a flat sheet at height z; `up` is the side of the probe.
std::vector<Path> over_flat(double z, double up) {
  return {{[=](double s) {
             return Spot{{s - 0.012, 0.4 * s - 0.005, z}, up * Vector3d::UnitZ()};
           },
           0.024}};
}

Subject thin_plate() {
  Subject made = subject("plate", "plate, 0.5 h thick", plate(kPlateThickness, 0.04));
  made.distance = [](const Vector3d& p) { return std::abs(p.z()) - 0.5 * kPlateThickness; };
  made.normal = [](const Vector3d& p, const Vector3d&) {
    return std::copysign(1.0, p.z()) * Vector3d::UnitZ();
  };
  made.spot = [](Random& r) {
    const double up = side(r);
    const double x = uniform(r, -0.012, 0.012);
    return Spot{{x, uniform(r, -0.012, 0.012), 0.5 * up * kPlateThickness}, up * Vector3d::UnitZ()};
  };
  made.paths = over_flat(0.5 * kPlateThickness, 1.0);
  made.probe_depth_m = 0.0;  // a probe inside would be about as near to one side as to the other
  made.crossings = true;
  made.friction = true;
  return made;
}

Subject two_sided_sheet() {
  Subject made = subject("sheet", "sheet, touched from both sides", plane(0.04));
  made.distance = [](const Vector3d& p) { return p.z(); };
  made.normal = [](const Vector3d&, const Vector3d&) { return Vector3d::UnitZ(); };
  made.spot = [](Random& r) {
    const double x = uniform(r, -0.012, 0.012);
    return Spot{{x, uniform(r, -0.012, 0.012), 0.0}, side(r) * Vector3d::UnitZ()};
  };
  made.paths = over_flat(0.0, 1.0);
  made.paths.push_back(over_flat(0.0, -1.0).front());
  made.crossings = true;
  made.friction = true;
  return made;
}

}  // namespace

std::vector<Subject> make_subjects(std::uint32_t seed, int lines) {
  // Separate random streams, because a cloud must not depend on the number of lines drawn before.
  std::uint32_t stream = 0;
  const auto next = [&] { return Random((std::uint64_t{seed} << 8) + ++stream); };
  const int few = lines / 4;
  std::vector<Subject> all;
  const auto add_cos = [&](const char* name, const char* title, Shape shape, int count) {
    Random random = next();
    all.push_back(over_cos(name, title, std::move(shape), random, count));
  };
  const auto add_sphere = [&](const char* name, const char* title, double spacing_m) {
    Random random = next();
    all.push_back(on_sphere(name, title, spacing_m, random, few));
  };
  const auto uneven = [&](double shift, double noise, double kept) {
    Random random = next();
    return uneven_cos(random, shift, noise, kept);
  };
  const double coarse = 2.5 * kSpacing;
  add_cos("cos", "cosine sheet", cos_sheet(), few);
  all.back().friction = true;
  add_sphere("sphere", "sphere, r = 30 mm", kSpacing);
  add_boxes(all);
  all.push_back(thin_plate());
  all.push_back(two_sided_sheet());
  add_cos("irregular", "cosine sheet, points moved by up to 0.4 h", uneven(0.4, 0.0, 1.0), lines);
  add_cos("thinned", "the same, 60 % of the points removed", uneven(0.4, 0.0, 0.4), lines);
  add_cos("noisy", "cosine sheet, points off by 5 % of h rms", uneven(0.0, 0.05, 1.0), few);
  add_cos("cos_coarse", "cosine sheet, h = 2.5 mm", cos_sheet(CosSheet{}, 0.05, coarse), few);
  add_sphere("sphere_coarse", "sphere, r = 30 mm, h = 2.5 mm", coarse);
  return all;
}

}  // namespace tactree::evaluation
