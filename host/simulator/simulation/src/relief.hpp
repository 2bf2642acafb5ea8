#pragma once
// Relief of a model from the side that most of its surface faces: height over a plane.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::simulation {

class Relief {
 public:
  /// Throws std::invalid_argument for an empty model. Cost: three passes over the points.
  explicit Relief(const core::BlobView& view);

  /// Height of the surface over (u, v), m: the highest point in a cell of about two spacings or, if
  /// it is empty, in the adjacent cells. False, w unchanged: no surface faces the viewer.
  [[nodiscard]] bool height(double u, double v, double& w) const;

  /// From the relief's frame to the model's.
  [[nodiscard]] Eigen::Vector3d to_model(const Eigen::Vector3d& uvw) const;

  /// Corners of the model in the relief's frame, m.
  [[nodiscard]] const Eigen::Vector3d& low() const { return low_; }
  [[nodiscard]] const Eigen::Vector3d& high() const { return high_; }
  /// Position (u, v) with a surface, nearest to the middle.
  [[nodiscard]] const Eigen::Vector2d& middle() const { return middle_; }

 private:
  [[nodiscard]] Eigen::Vector3d to_relief(const Eigen::Vector3d& xyz) const;
  void choose_view(const core::BlobView& view);
  void fill(const core::BlobView& view);
  void find_middle();
  /// NaN: no surface.
  [[nodiscard]] double cell(std::ptrdiff_t column, std::ptrdiff_t row) const;
  [[nodiscard]] std::ptrdiff_t column(double u) const;
  [[nodiscard]] std::ptrdiff_t row(double v) const;

  Eigen::Index axis_ = 2;  // of the model that is w
  double sign_ = 1.0;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double cell_m_ = 0.0;
  std::ptrdiff_t columns_ = 0;
  std::ptrdiff_t rows_ = 0;
  std::vector<double> heights_;  // NaN: nothing there
};

}  // namespace tactree::simulation
