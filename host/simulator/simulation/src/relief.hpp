#pragma once
// Relief of a model: heights over a plane, seen from the side that most of its surface faces.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::simulation {

class Relief {
 public:
  /// Throws std::invalid_argument for an empty model. Cost: three passes over the points.
  explicit Relief(const core::BlobView& view);

  /// Sets w to the height of the surface over (u, v), m: the highest point in a cell of about two
  /// spacings or, if the cell is empty, in the adjacent cells. Returns false and leaves w unchanged
  /// if no surface there faces the viewer.
  [[nodiscard]] bool height(double u, double v, double& w) const;

  /// From the relief's frame to the model's.
  [[nodiscard]] Eigen::Vector3d to_model(const Eigen::Vector3d& uvw) const;

  /// Bounding box of the model in the relief's frame, m.
  [[nodiscard]] const Eigen::Vector3d& low() const { return low_; }
  [[nodiscard]] const Eigen::Vector3d& high() const { return high_; }
  /// Position (u, v) with a surface, nearest to the centre of the bounding box.
  [[nodiscard]] const Eigen::Vector2d& middle() const { return middle_; }

 private:
  [[nodiscard]] Eigen::Vector3d to_relief(const Eigen::Vector3d& xyz) const;
  void choose_view(const core::BlobView& view);
  void fill(const core::BlobView& view);
  void find_middle();
  /// Height of a cell; NaN without a surface.
  [[nodiscard]] double cell(std::ptrdiff_t column, std::ptrdiff_t row) const;
  [[nodiscard]] std::ptrdiff_t column(double u) const;
  [[nodiscard]] std::ptrdiff_t row(double v) const;

  Eigen::Index axis_ = 2;  // the axis of the model that is w
  double sign_ = 1.0;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double cell_m_ = 0.0;
  std::ptrdiff_t columns_ = 0;
  std::ptrdiff_t rows_ = 0;
  std::vector<double> heights_;  // by cell; NaN without a surface
};

}  // namespace tactree::simulation
