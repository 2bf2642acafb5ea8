#include "tactree/simulation/workspace.hpp"

#include <algorithm>
#include <vector>

#include "tactree/core/device/kinematics.hpp"
#include "tactree/plant/linkage.hpp"

namespace tactree::simulation {
namespace {

constexpr double kMeets_m = 1e-5;   // maximum distance of the tip from a position that it reaches
constexpr int kPerEdge = 5;         // points: 5^3 - 3^3 = 98 on the faces
constexpr double kAccuracy = 1e-3;  // relative, of largest_scale()

/// Points on the faces of the cube from -1 to 1.
std::vector<Eigen::Vector3d> face_points() {
  std::vector<Eigen::Vector3d> points;
  const auto at = [](int i) { return 2.0 * i / (kPerEdge - 1) - 1.0; };
  for (int x = 0; x < kPerEdge; ++x) {
    for (int y = 0; y < kPerEdge; ++y) {
      for (int z = 0; z < kPerEdge; ++z) {
        const Eigen::Vector3d point(at(x), at(y), at(z));
        if (point.cwiseAbs().maxCoeff() == 1.0) {
          points.push_back(point);
        }
      }
    }
  }
  return points;
}

}  // namespace

bool reaches(const core::DeviceModel& device, const Eigen::Vector3d& place_m) {
  const plant::Linkage linkage(device);
  const Eigen::Vector3d joints = linkage.joints_near(place_m);
  const auto pose = linkage.pose(joints);
  if (!pose || (pose->tip_m - place_m).norm() > kMeets_m) {
    return false;
  }
  const Eigen::Vector3f q = joints.cast<float>();
  const core::DevicePose found = core::locate_joints(device, {q.x(), q.y(), q.z()});
  return found.valid && found.reach == 1.0F;
}

bool reaches_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m) {
  if (core::axes_of(device.kind) != core::kAxes) {
    return true;
  }
  const std::vector<Eigen::Vector3d> points = face_points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return reaches(device, 0.5 * point.cwiseProduct(size_m));
  });
}

std::optional<double> largest_scale(const core::DeviceModel& device,
                                    const Eigen::Vector3d& size_m) {
  const double edge = size_m.maxCoeff();
  if (core::axes_of(device.kind) != core::kAxes || !(edge > 0.0)) {
    return std::nullopt;
  }
  const auto fits = [&](double scale) { return reaches_box(device, scale * size_m); };
  // Starts with a box of 0.1 mm, doubles it while it fits, then bisects.
  double low = 1e-4 / edge;
  if (!fits(low)) {
    return 0.0;
  }
  while (low < kMaxScale && fits(2.0 * low)) {
    low *= 2.0;
  }
  double high = 2.0 * low;
  while (high > low * (1.0 + kAccuracy)) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return std::min(low, kMaxScale);
}

}  // namespace tactree::simulation
