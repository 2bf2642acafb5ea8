#pragma once
// Reference surface: APSS in double precision over all points, projected until convergence. It is
// slow, and independent of the code under test.

#include <Eigen/Core>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::evaluation {

class ReferenceSurface {
 public:
  /// Uses the decoded points of a blob and its support radius.
  explicit ReferenceSurface(const core::BlobView& view);

  struct Projection {
    bool supported = false;
    bool creased = false;  ///< normals in the support differ by more than 47 degrees
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double signed_distance = 0.0;
  };
  /// The nearest point provides the reference normal. Cost: a pass over all points, then about ten
  /// fits.
  [[nodiscard]] Projection project(const Eigen::Vector3d& x) const;

  [[nodiscard]] const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& normals() const { return normals_; }

 private:
  struct Fit;
  [[nodiscard]] bool is_creased(const std::vector<std::size_t>& around,
                                const Eigen::Vector3d& x) const;
  [[nodiscard]] Fit fit(const std::vector<std::size_t>& around, const Eigen::Vector3d& x,
                        const Eigen::Vector3d& reference) const;

  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector3d> normals_;
  double radius_;
};

}  // namespace tactree::evaluation
