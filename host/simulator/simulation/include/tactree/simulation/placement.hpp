#pragma once
// Placement of a model in front of a device.

#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "tactree/core/device/device_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::simulation {

/// Pose and size of a model in the frame of the device: device = pose * (scale * model).
struct Placement {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double scale = 1.0;
};

/// Limits of Placement::scale, as far as no command knows the model better.
inline constexpr double kSmallestPlacedScale = 1e-6;
inline constexpr double kLargestPlacedScale = 1e6;

/// A 4x4 matrix, row by row, as users and programs write a pose.
using PoseRows = std::array<double, 16>;

/// Why a matrix is not a pose, and what to do.
struct PoseProblem {
  const char* cause;
  const char* remedy;
};
/// Empty for the matrix of a pose. Deviations of up to 1e-3 from a rotation are accepted, because
/// files are written by hand.
[[nodiscard]] std::optional<PoseProblem> problem_of(const PoseRows& rows);
/// Precondition: the matrix has no problem.
[[nodiscard]] Eigen::Isometry3d pose_of(const PoseRows& rows);
[[nodiscard]] PoseRows rows_of(const Eigen::Isometry3d& pose);

/// Origin of the scene in the device frame for which the centre of the model, at `pose` in the
/// scene, is at the device's origin. For a device of one or two axes, whose workspace is small, the
/// centre of the model's top is placed there instead.
[[nodiscard]] core::Vec3 middle_at_origin(const core::BlobHeader& model,
                                          const Eigen::Isometry3d& pose, core::DeviceKind kind);

/// The pose, in a scene whose origin is at `origin_m` in the device frame, of a pose in the device
/// frame, and the reverse.
[[nodiscard]] Eigen::Isometry3d in_scene(const Eigen::Isometry3d& in_device,
                                         const core::Vec3& origin_m);
[[nodiscard]] Eigen::Isometry3d in_device(const Eigen::Isometry3d& in_scene,
                                          const core::Vec3& origin_m);

}  // namespace tactree::simulation
