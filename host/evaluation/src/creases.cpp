#include "tactree/evaluation/creases.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace tactree::evaluation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kWall = 0.012;  // thickness below and beside a groove, m

/// A rectangle from `corner` along u and v.
struct Face {
  Vector3d corner;
  Vector3d u;  // m
  Vector3d v;
  Vector3d normal;
};

class Sampler {
 public:
  Sampler(double spacing_m, double shift, double noise, unsigned seed)
      : shape_(spacing_m), shift_(shift), noise_(noise), random_(seed) {}

  void add(const Face& face, const Matrix3d& turn) {
    const double h = shape_.model().spacing_m;
    const auto rows = std::max(1L, std::lround(face.u.norm() / h));
    const auto columns = std::max(1L, std::lround(face.v.norm() / h));
    for (long i = 0; i < rows; ++i) {
      for (long j = 0; j < columns; ++j) {
        const double a = (static_cast<double>(i) + 0.5 + shift_ * unit_(random_)) / double(rows);
        const double b = (static_cast<double>(j) + 0.5 + shift_ * unit_(random_)) / double(columns);
        const double off = noise_ * h * error_(random_);
        shape_.add(turn * (face.corner + a * face.u + b * face.v + off * face.normal),
                   turn * face.normal);
      }
    }
  }
  Shape take() {
    shape_.seal();
    return std::move(shape_);
  }

 private:
  Shape shape_;
  double shift_;
  double noise_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  std::normal_distribution<double> error_;
};

double cross2(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

double Prism::distance(const Vector3d& place) const {
  const Vector3d local = turn.transpose() * place;
  const Vector2d p(local.x(), local.z());
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vector2d& a = profile[i];
    const Vector2d& b = profile[(i + 1) % profile.size()];
    const Vector2d along = b - a;
    const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - a - share * along).norm());
    if ((a.y() > p.y()) != (b.y() > p.y())) {
      const double side = cross2(along, p - a);
      inside = inside != ((b.y() > a.y()) == (side > 0.0));
    }
  }
  return inside ? -nearest : nearest;
}

Prism groove(double angle_deg) {
  const double slope = std::tan(0.5 * angle_deg * kDegree);
  const double half = std::min(0.02, 0.01 * slope);
  const double depth = half / slope;
  const double side = half + kWall;
  return {.profile = {{-side, -kWall},
                      {side, -kWall},
                      {side, depth},
                      {half, depth},
                      {0.0, 0.0},
                      {-half, depth},
                      {-side, depth}}};
}

Prism ridge(double angle_deg) {
  const double slope = std::tan(0.5 * angle_deg * kDegree);
  const double half = std::min(0.02, 0.02 * slope);
  return {.profile = {{-half, -half / slope}, {half, -half / slope}, {0.0, 0.0}}};
}

Prism slot(double width_m) {
  const double half = 0.5 * width_m;
  const double side = half + kWall;
  return {.profile = {{-side, -kWall},
                      {side, -kWall},
                      {side, 0.01},
                      {half, 0.01},
                      {half, 0.0},
                      {-half, 0.0},
                      {-half, 0.01},
                      {-side, 0.01}}};
}

Shape sampled(const Prism& prism, double spacing_m, double shift, double noise, unsigned seed) {
  Sampler sampler(spacing_m, shift, noise, seed);
  for (std::size_t i = 0; i < prism.profile.size(); ++i) {
    const Vector2d& a = prism.profile[i];
    const Vector2d along = prism.profile[(i + 1) % prism.profile.size()] - a;
    const Vector2d out = Vector2d(along.y(), -along.x()).normalized();
    sampler.add({{a.x(), -prism.half_m, a.y()},
                 {along.x(), 0.0, along.y()},
                 {0.0, 2.0 * prism.half_m, 0.0},
                 {out.x(), 0.0, out.y()}},
                prism.turn);
  }
  return sampler.take();
}

Shape room(double half_m, double spacing_m, double shift, unsigned seed, const Matrix3d& turn) {
  Sampler sampler(spacing_m, shift, 0.0, seed);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Face face;
      face.u = 2.0 * half_m * Vector3d::Unit((axis + 1) % 3);
      face.v = 2.0 * half_m * Vector3d::Unit((axis + 2) % 3);
      face.corner = side * half_m * Vector3d::Unit(axis) - 0.5 * (face.u + face.v);
      face.normal = -side * Vector3d::Unit(axis);
      sampler.add(face, turn);
    }
  }
  return sampler.take();
}

Matrix3d any_turn(std::mt19937_64& random) {
  std::normal_distribution<double> any;
  const double w = any(random);
  const double x = any(random);
  const double y = any(random);
  return Eigen::Quaterniond(w, x, y, any(random)).normalized().toRotationMatrix();
}

}  // namespace tactree::evaluation
