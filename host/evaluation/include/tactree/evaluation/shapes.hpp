#pragma once
// Sampled surfaces with known distances and normals, as blobs.

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "tactree/builder/model.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/plant/vectors.hpp"

namespace tactree::evaluation {

inline constexpr double kSpacing = 1e-3;  // m, default point spacing h

using plant::narrow;
using plant::widen;

/// A model and its blob. Move-only, because the view refers to the blob's bytes.
class Shape {
 public:
  explicit Shape(double spacing_m = kSpacing);
  Shape(Shape&&) = default;
  Shape& operator=(Shape&&) = default;

  void add(const Eigen::Vector3d& position, const Eigen::Vector3d& normal);
  builder::Model& model() { return model_; }
  /// Writes and opens the blob; throws std::runtime_error if it is invalid.
  void seal();
  /// The same points in a blob for paper mode, sealed.
  [[nodiscard]] Shape paper_twin() const;

  [[nodiscard]] const core::BlobView& view() const { return view_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return written_.bytes; }

 private:
  builder::Model model_;
  builder::WrittenBlob written_;
  core::BlobView view_;
};

/// Adds a square sheet z = height_m with points on a grid and the normal (0, 0, up). Does not seal
/// the shape.
void add_sheet(Shape& shape, double half_m, double height_m, double up);

[[nodiscard]] Shape plane(double half_m = 0.03);

/// Two sheets that face away from each other, symmetric about z = 0.
[[nodiscard]] Shape plate(double thickness_m, double half_m = 0.02);

inline constexpr double kSphereRadius = 0.03;

/// Sphere with points on a golden spiral, which are evenly spaced and form no rows.
[[nodiscard]] Shape sphere(double radius_m = kSphereRadius, double spacing_m = kSpacing);

/// z = a (cos kx + cos ky), with principal curvatures from -ak^2 to ak^2.
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
  /// The point of the sheet nearest to `p`. Precondition: the distance of p is less than half the
  /// minimum radius of curvature.
  [[nodiscard]] Eigen::Vector3d nearest(const Eigen::Vector3d& p) const;
};

/// Square sheet with points on a grid in x and y.
[[nodiscard]] Shape cos_sheet(const CosSheet& sheet = {}, double half_m = 0.04,
                              double spacing_m = kSpacing);

/// Cube with sharp edges, centred at the origin. Its points are on the faces, half a spacing from
/// the edges, each displaced along its face by up to `shift` spacings at random.
[[nodiscard]] Shape box(double half_m, double shift = 0.0, unsigned seed = 1,
                        double spacing_m = kSpacing,
                        const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

}  // namespace tactree::evaluation
