#include "tactree/simulation/placement.hpp"

#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {
namespace {

using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

// Deviation of a rotation's rows from unit length and right angles that is accepted.
constexpr double kRotationTolerance = 1e-3;

}  // namespace

std::optional<PoseProblem> problem_of(const PoseRows& rows) {
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(rows.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::Matrix3d off = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
  if (!(off.cwiseAbs().maxCoeff() <= kRotationTolerance) || !(rotation.determinant() > 0.0)) {
    return PoseProblem{"its upper left 3x3 part is not a rotation",
                       "remove scale, shear and mirroring; scale with `tactree build --scale`"};
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    return PoseProblem{"its last row is not 0, 0, 0, 1", "write the matrix row by row"};
  }
  return std::nullopt;
}

Eigen::Isometry3d pose_of(const PoseRows& rows) {
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(rows.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

PoseRows rows_of(const Eigen::Isometry3d& pose) {
  PoseRows rows{};
  Eigen::Map<RowMajor>(rows.data()) = pose.matrix();
  return rows;
}

core::Vec3 middle_at_origin(const core::BlobHeader& model, const Eigen::Isometry3d& pose,
                            core::DeviceKind kind) {
  const Eigen::Vector3f low(model.bounds_min_m);
  const Eigen::Vector3f high(model.bounds_max_m);
  Eigen::Vector3f held = 0.5F * (low + high);
  if (core::axes_of(kind) != core::kAxes) {
    held.z() = high.z();
  }
  held = pose.cast<float>() * held;
  return {-held.x(), -held.y(), -held.z()};
}

Eigen::Isometry3d in_scene(const Eigen::Isometry3d& in_device, const core::Vec3& origin_m) {
  return Eigen::Translation3d(-plant::widen(origin_m)) * in_device;
}

Eigen::Isometry3d in_device(const Eigen::Isometry3d& in_scene, const core::Vec3& origin_m) {
  return Eigen::Translation3d(plant::widen(origin_m)) * in_scene;
}

}  // namespace tactree::simulation
