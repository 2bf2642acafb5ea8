#pragma once
// Input cleaning: joins the scans, drops unusable points and faces, and moves the rest to the model
// frame.

#include <vector>

#include "cleaning/crop.hpp"
#include "geometry/mesh.hpp"
#include "geometry/z_order.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Transform from source to model coordinates:
///   model = fit * (unit * turn * source - shift)
struct ModelFrame {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double unit = 1.0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double fit = 1.0;

  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& source) const {
    return unit * (turn * source);
  }
  [[nodiscard]] Eigen::Vector3d placed(const Eigen::Vector3d& source) const {
    return fit * (turned(source) - shift);
  }
  [[nodiscard]] double source_scale() const { return fit * unit; }
  /// The model's origin, in source coordinates.
  [[nodiscard]] Eigen::Vector3d source_origin() const { return turn.transpose() * shift / unit; }
  /// A position of the model, in source coordinates.
  [[nodiscard]] Eigen::Vector3d source_of(const Eigen::Vector3d& model) const {
    return turn.transpose() * (model / fit + shift) / unit;
  }
};

/// All inputs, joined and cleaned, in the model frame. Points or mesh may be empty, but not both.
struct CleanInput {
  ZOrderedCloud points;         ///< of clouds
  double points_spacing = 0.0;  ///< median spacing; 0 for fewer than two points
  Mesh mesh;                    ///< of meshes
  Crop crop;                    ///< of meshes: faces may extend beyond it
  ModelFrame frame;
  Box bounds;  ///< of the part inside the crop
};

/// Joins the scans, drops outliers, duplicates and damaged faces, and transforms the rest. Counts
/// and notes go to `report`. Throws std::runtime_error if nothing is left.
[[nodiscard]] CleanInput clean(std::vector<Scan> scans, const BuildOptions& options,
                               BuildReport& report);

}  // namespace tactree::builder
