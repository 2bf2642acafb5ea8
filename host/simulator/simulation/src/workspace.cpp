#include "tactree/simulation/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tactree/core/device/kinematics.hpp"
#include "tactree/plant/linkage.hpp"
#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {
namespace {

constexpr double kMeets_m = 1e-5;  // maximum distance of the tip from a position that it reaches
constexpr double kNearStart_m = 5e-3;  // for devices whose probe moves in a plane or on an arc
constexpr int kPerEdge = 5;            // points: 5^3 - 3^3 = 98 on the faces
constexpr double kAccuracy = 1e-3;     // relative, of largest_scale()

// Of reach_shape(): small against a workspace, so that the first border on the way is found.
constexpr double kStep_m = 0.02;
constexpr double kFarthest_m = 2.0;
constexpr double kBorder_m = 1e-3;
constexpr int kRows = 11;  // of a surface
constexpr int kColumns = 24;

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

/// Position on the border of the workspace. Precondition: `from` is reached.
Eigen::Vector3d border_along(const core::DeviceModel& device, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& direction) {
  const auto at = [&](double distance) { return (from + distance * direction).eval(); };
  double low = 0.0;
  while (low < kFarthest_m && reaches(device, at(low + kStep_m))) {
    low += kStep_m;
  }
  double high = low + kStep_m;
  while (high - low > kBorder_m) {
    const double middle = 0.5 * (low + high);
    (reaches(device, at(middle)) ? low : high) = middle;
  }
  return at(low);
}

ReachShape reached_surface(const core::DeviceModel& device) {
  ReachShape shape{kRows, kColumns, {}};
  for (int row = 0; row < kRows; ++row) {
    const double height = std::numbers::pi * (static_cast<double>(row) / (kRows - 1) - 0.5);
    for (int column = 0; column < kColumns; ++column) {
      const double turn = 2.0 * std::numbers::pi * column / kColumns;
      const Eigen::Vector3d direction(std::cos(height) * std::cos(turn),
                                      std::cos(height) * std::sin(turn), std::sin(height));
      shape.points_m.push_back(border_along(device, Eigen::Vector3d::Zero(), direction));
    }
  }
  return shape;
}

/// In the plane of a five-bar.
ReachShape reached_area(const core::DeviceModel& device, const Eigen::Vector3d& middle) {
  ReachShape shape{2, kColumns, std::vector<Eigen::Vector3d>(kColumns, middle)};
  for (int column = 0; column < kColumns; ++column) {
    const double turn = 2.0 * std::numbers::pi * column / kColumns;
    shape.points_m.push_back(border_along(device, middle, {0.0, std::cos(turn), std::sin(turn)}));
  }
  return shape;
}

/// Of a paddle.
ReachShape reached_arc(const core::DeviceModel& device) {
  const auto limit = [](float joint) {
    return std::clamp(static_cast<double>(joint), -std::numbers::pi, std::numbers::pi);
  };
  const double low = limit(device.joint_min[0]);
  const double high = limit(device.joint_max[0]);
  const plant::Linkage linkage(device);
  ReachShape shape{1, kColumns, {}};
  for (int column = 0; column < kColumns; ++column) {
    const double way = 1.0 - std::abs(2.0 * column / kColumns - 1.0);
    const auto pose = linkage.pose({low + way * (high - low), 0.0, 0.0});
    shape.points_m.push_back(pose->tip_m);
  }
  return shape;
}

/// Position of the probe of a device of one or two axes at this height, and for a paddle at its own
/// y. Empty if the height is beyond the paddle.
std::optional<Eigen::Vector3d> place_on_path(const core::DeviceModel& device, double y, double z) {
  const Eigen::Vector3d origin = plant::widen(device.origin_m);
  if (device.kind == core::DeviceKind::kFiveBar) {
    return Eigen::Vector3d(-origin.x(), y, z);
  }
  const auto length = static_cast<double>(device.paddle_m);
  const double height = z + origin.z();
  if (std::abs(height) > length) {
    return std::nullopt;
  }
  return Eigen::Vector3d(std::sqrt(length * length - height * height) - origin.x(), -origin.y(), z);
}

/// Of a box whose top has its centre at the origin: the edges of the section of which the probe of
/// a device of one or two axes moves in the plane.
bool reaches_hanging_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m) {
  const std::vector<Eigen::Vector3d> points = face_points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    const double y = 0.5 * point.y() * size_m.y();
    const auto place = place_on_path(device, y, 0.5 * (point.z() - 1.0) * size_m.z());
    return point.x() != 1.0 || (place && reaches(device, *place));
  });
}

}  // namespace

bool comes_near(const core::DeviceModel& device, const Eigen::Vector3d& place_m,
                double distance_m) {
  const plant::Linkage linkage(device);
  const Eigen::Vector3d joints = linkage.joints_near(place_m);
  const auto pose = linkage.pose(joints);
  if (!pose || (pose->tip_m - place_m).norm() > distance_m) {
    return false;
  }
  const Eigen::Vector3f q = joints.cast<float>();
  const core::DevicePose found = core::locate_joints(device, {q.x(), q.y(), q.z()});
  return found.valid && found.reach == 1.0F;
}

bool reaches(const core::DeviceModel& device, const Eigen::Vector3d& place_m) {
  return comes_near(device, place_m, kMeets_m);
}

bool reaches_start(const core::DeviceModel& device, const Eigen::Vector3d& start_m) {
  return comes_near(device, start_m,
                    core::axes_of(device.kind) == core::kAxes ? kMeets_m : kNearStart_m);
}

bool reaches_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m) {
  return core::axes_of(device.kind) == core::kAxes
             ? reaches_box(device, Eigen::Isometry3d::Identity(), size_m)
             : reaches_hanging_box(device, size_m);
}

bool reaches_box(const core::DeviceModel& device, const Eigen::Isometry3d& pose,
                 const Eigen::Vector3d& size_m) {
  const std::vector<Eigen::Vector3d> points = face_points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return reaches(device, pose * (0.5 * point.cwiseProduct(size_m)));
  });
}

std::optional<double> largest_scale(const core::DeviceModel& device,
                                    const Eigen::Vector3d& size_m) {
  const double edge = size_m.maxCoeff();
  if (!(edge > 0.0)) {
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

ReachShape reach_shape(const core::DeviceModel& device) {
  const std::uint32_t axes = core::axes_of(device.kind);
  if (axes == 1) {
    return reached_arc(device);
  }
  const auto middle = axes == 2 ? place_on_path(device, 0.0, 0.0) : Eigen::Vector3d::Zero().eval();
  if (!reaches(device, *middle)) {
    return {};
  }
  return axes == 2 ? reached_area(device, *middle) : reached_surface(device);
}

}  // namespace tactree::simulation
