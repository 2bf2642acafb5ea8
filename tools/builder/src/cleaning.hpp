#pragma once
// From what the files hold to what is worth building from.

#include <map>
#include <string>
#include <vector>

#include "mesh_sampling.hpp"
#include "tactree/builder/build_model.hpp"
#include "z_order.hpp"

namespace tactree::builder {

/// A place in the model frame as a function of its place in the source:
///   model = fit * (unit * turn * source - shift)
struct Frame {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double unit = 1.0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double fit = 1.0;

  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& source) const {
    return unit * (turn * source);
  }
  [[nodiscard]] double source_scale() const { return fit * unit; }
  /// Where the model's origin is in the source.
  [[nodiscard]] Eigen::Vector3d source_origin() const { return turn.transpose() * shift / unit; }
};

/// All inputs together, clean, in the model frame; at least one of the two is not empty.
struct CleanInput {
  ZOrderedCloud points;         ///< of clouds
  double points_spacing = 0.0;  ///< their own; 0 when there are fewer than two
  Mesh mesh;                    ///< of meshes
  Box crop;                     ///< model frame; empty: none. The mesh may reach beyond
  Frame frame;
  Box bounds;  ///< without what the crop removes
};

/// Joins the scans, drops what is of no use, places the rest; counts and tells in `report`.
/// Throws std::runtime_error when nothing is left.
[[nodiscard]] CleanInput clean(std::vector<Scan> scans, const BuildOptions& options,
                               BuildReport& report);

}  // namespace tactree::builder
