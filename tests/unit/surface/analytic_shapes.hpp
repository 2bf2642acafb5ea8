#pragma once
// Surfaces whose every distance and normal is known, sampled and written as blobs.

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tactree/builder/model.hpp"
#include "tactree/core/blob.hpp"

namespace tactree::test {

inline constexpr double kSpacing = 1e-3;  // m, h

inline core::Vec3 narrow(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

inline Eigen::Vector3d widen(core::Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// A model and the blob made of it.
class Shape {
 public:
  explicit Shape(double spacing_m = kSpacing) {
    model_.spacing_m = spacing_m;
    model_.support_radius_m = 2.5 * spacing_m;
    model_.reach_m = 3.0 * spacing_m;
    model_.name = "test";
  }
  void add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) {
    model_.positions.push_back(position);
    model_.normals.push_back(normal.normalized().cast<float>());
  }
  builder::Model& model() { return model_; }
  /// Writes and opens the blob.
  void seal() {
    written_ = builder::write_blob(model_);
    if (core::open_blob(written_.bytes, view_) != core::BlobStatus::kOk) {
      throw std::runtime_error("the shape's blob is refused");
    }
  }
  [[nodiscard]] const core::BlobView& view() const { return view_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return written_.bytes; }

 private:
  builder::Model model_;
  builder::WrittenBlob written_;
  core::BlobView view_;
};

/// A square sheet z = height, normal up or down.
inline void add_sheet(Shape& shape, double half_m, double height_m, double up) {
  const double h = shape.model().spacing_m;
  const int n = static_cast<int>(std::lround(half_m / h));
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      shape.add({i * h, j * h, height_m}, {0.0, 0.0, up});
    }
  }
}

inline Shape plane(double half_m = 0.03) {
  Shape shape;
  add_sheet(shape, half_m, 0.0, 1.0);
  shape.seal();
  return shape;
}

/// Two sheets facing away from each other, about z = 0.
inline Shape plate(double thickness_m, double half_m = 0.02) {
  Shape shape;
  add_sheet(shape, half_m, 0.5 * thickness_m, 1.0);
  add_sheet(shape, half_m, -0.5 * thickness_m, -1.0);
  shape.seal();
  return shape;
}

inline constexpr double kSphereRadius = 0.03;

/// Golden spiral: even, without rows.
inline Shape sphere(double radius_m = kSphereRadius) {
  Shape shape;
  const double h = shape.model().spacing_m;
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

/// z = a (cos kx + cos ky): every curvature from -2ak^2 to 2ak^2.
struct CosSheet {
  double amplitude_m = 2.5e-3;
  double wave_number = 2.0 * std::numbers::pi / 0.06;  // 1/m

  [[nodiscard]] double height(double x, double y) const {
    return amplitude_m * (std::cos(wave_number * x) + std::cos(wave_number * y));
  }
  [[nodiscard]] Eigen::Vector3d normal(double x, double y) const {
    const double slope = amplitude_m * wave_number;
    return Eigen::Vector3d(slope * std::sin(wave_number * x), slope * std::sin(wave_number * y),
                           1.0)
        .normalized();
  }
  [[nodiscard]] Eigen::Vector3d point(double x, double y) const { return {x, y, height(x, y)}; }
};

inline Shape cos_sheet(const CosSheet& sheet = {}, double half_m = 0.04) {
  Shape shape;
  const double h = shape.model().spacing_m;
  const int n = static_cast<int>(std::lround(half_m / h));
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      shape.add(sheet.point(i * h, j * h), sheet.normal(i * h, j * h));
    }
  }
  shape.seal();
  return shape;
}

/// Cube about the origin with sharp edges; points on the faces, half a spacing from the edges.
inline Shape box(double half_m) {
  Shape shape;
  const double h = shape.model().spacing_m;
  const int n = static_cast<int>(std::lround(2.0 * half_m / h));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          Eigen::Vector3d p;
          p[axis] = side * half_m;
          p[(axis + 1) % 3] = (i + 0.5) * h - half_m;
          p[(axis + 2) % 3] = (j + 0.5) * h - half_m;
          Eigen::Vector3d normal = Eigen::Vector3d::Zero();
          normal[axis] = side;
          shape.add(p, normal);
        }
      }
    }
  }
  shape.seal();
  return shape;
}

}  // namespace tactree::test
