#include "tactree/evaluation/shapes.hpp"

#include <random>
#include <stdexcept>

namespace tactree::evaluation {

Shape::Shape(double spacing_m) {
  model_.spacing_m = spacing_m;
  model_.support_radius_m = 2.5 * spacing_m;
  model_.reach_m = 3.0 * spacing_m;
  model_.name = "test";
  model_.tells_interior = true;
}

void Shape::add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
  model_.positions.push_back(position);
  model_.normals.push_back(normal.normalized().cast<float>());
}

void Shape::seal() {
  written_ = builder::write_blob(model_);
  if (core::open_blob(written_.bytes, view_) != core::BlobStatus::kOk) {
    throw std::runtime_error("the blob of the shape is invalid");
  }
}

Shape Shape::paper_twin() const {
  Shape twin(model_.spacing_m);
  twin.model_ = model_;
  twin.model_.profile = core::Profile::kPaper;
  twin.seal();
  return twin;
}

void add_sheet(Shape& shape, double half_m, double height_m, double up) {
  const double h = shape.model().spacing_m;
  const int n = static_cast<int>(std::lround(half_m / h));
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      shape.add({i * h, j * h, height_m}, {0.0, 0.0, up});
    }
  }
}

Shape plane(double half_m) {
  Shape shape;
  add_sheet(shape, half_m, 0.0, 1.0);
  shape.seal();
  return shape;
}

Shape plate(double thickness_m, double half_m) {
  Shape shape;
  add_sheet(shape, half_m, 0.5 * thickness_m, 1.0);
  add_sheet(shape, half_m, -0.5 * thickness_m, -1.0);
  shape.seal();
  return shape;
}

Shape sphere(double radius_m, double spacing_m) {
  Shape shape(spacing_m);
  const double h = spacing_m;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const int n = static_cast<int>(1.15 * 4.0 * std::numbers::pi * radius_m * radius_m / (h * h));
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / n;
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d d(r * std::cos(golden * i), r * std::sin(golden * i), z);
    shape.add(radius_m * d, d);
  }
  shape.seal();
  return shape;
}

Eigen::Vector3d CosSheet::nearest(const Eigen::Vector3d& p) const {
  Eigen::Vector3d foot = point(p.x(), p.y());
  // Each step reduces the error by the factor height * curvature, for example 1 mm * 27/m.
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d n = normal(foot.x(), foot.y());
    const Eigen::Vector3d offset = p - foot;
    const Eigen::Vector3d along = offset - offset.dot(n) * n;
    foot = point(foot.x() + along.x(), foot.y() + along.y());
  }
  return foot;
}

Shape cos_sheet(const CosSheet& sheet, double half_m, double spacing_m) {
  Shape shape(spacing_m);
  const double h = spacing_m;
  const int n = static_cast<int>(std::lround(half_m / h));
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      shape.add(sheet.point(i * h, j * h), sheet.normal(i * h, j * h));
    }
  }
  shape.seal();
  return shape;
}

Shape box(double half_m, double shift, unsigned seed, double spacing_m,
          const Eigen::Matrix3d& turn) {
  Shape shape(spacing_m);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto place = [&](int i, double h) { return (i + 0.5 + shift * unit(random)) * h - half_m; };
  const double h = shape.model().spacing_m;
  const int n = static_cast<int>(std::lround(2.0 * half_m / h));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          Eigen::Vector3d p;
          p[axis] = side * half_m;
          p[(axis + 1) % 3] = place(i, h);
          p[(axis + 2) % 3] = place(j, h);
          Eigen::Vector3d normal = Eigen::Vector3d::Zero();
          normal[axis] = side;
          shape.add(turn * p, turn * normal);
        }
      }
    }
  }
  shape.seal();
  return shape;
}

}  // namespace tactree::evaluation
