#include "tactree/plant/linkage.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tactree/plant/trigonometry.hpp"
#include "tactree/plant/vectors.hpp"

namespace tactree::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDifference = 1e-6;  // rad or m, step of the numerical gradient of a closure
constexpr int kNewtonSteps = 60;
constexpr double kConverged_m = 1e-12;

Matrix3d turn_z(double angle_rad) {
  const SineCosine a = sine_cosine(angle_rad);
  Matrix3d m;
  m << a.cosine, -a.sine, 0.0, a.sine, a.cosine, 0.0, 0.0, 0.0, 1.0;
  return m;
}

/// `forward` rotated upwards about the horizontal axis to its right.
Vector3d elevated(const Vector3d& forward, double angle_rad) {
  const SineCosine a = sine_cosine(angle_rad);
  return a.cosine * forward + a.sine * Vector3d::UnitZ();
}

/// Positions of the arm's joints.
struct ArmPoints {
  Vector3d axis;  // of the elevation joints
  Vector3d elbow;
  Vector3d forearm;  // unit vector
  Vector3d tip;
};

ArmPoints arm_points(const core::ArmGeometry& g, const Vector3d& q) {
  const Matrix3d base = turn_z(q[0]);
  const Vector3d forward = base.col(0);
  const double swing = q[2] + static_cast<double>(g.coupling) * q[1];
  ArmPoints p;
  p.axis = -base.col(1);
  p.elbow = static_cast<double>(g.arm_m) * elevated(forward, q[1]);
  const SineCosine s = sine_cosine(swing);
  p.forearm = s.sine * forward - s.cosine * Vector3d::UnitZ();
  p.tip = p.elbow + static_cast<double>(g.forearm_m) * p.forearm;
  return p;
}

LinkagePose arm_pose(const core::ArmGeometry& g, const Vector3d& q) {
  const ArmPoints p = arm_points(g, q);
  LinkagePose pose;
  pose.tip_m = p.tip;
  const Vector3d by_forearm = p.axis.cross(p.tip - p.elbow);
  pose.jacobian.col(0) = Vector3d::UnitZ().cross(p.tip);
  pose.jacobian.col(1) = p.axis.cross(p.elbow) + static_cast<double>(g.coupling) * by_forearm;
  pose.jacobian.col(2) = by_forearm;
  return pose;
}

/// Closure error of each leg of a delta, m2, by the position of its plate.
class DeltaClosure {
 public:
  DeltaClosure(const core::DeltaGeometry& g, const Vector3d& q) : g_(g) {
    for (std::size_t i = 0; i < core::kAxes; ++i) {
      places_[i] = sine_cosine(static_cast<double>(g.leg_rad[i]));
      arms_[i] = sine_cosine(q[static_cast<Eigen::Index>(i)]);
    }
  }

  Vector3d operator()(const Vector3d& plate) const {
    return {misfit(0, plate), misfit(1, plate), misfit(2, plate)};
  }

 private:
  double misfit(std::size_t leg, const Vector3d& plate) const {
    const SineCosine& place = places_[leg];
    const SineCosine& arm = arms_[leg];
    // Stamper's frame: x and y in the plane of the ring, z normal to it.
    const double x = plate.y();
    const double y = plate.z();
    const double u = x * place.cosine + y * place.sine - static_cast<double>(g_.r);
    const double v = -x * place.sine + y * place.cosine - static_cast<double>(g_.s);
    const double side = v + static_cast<double>(g_.f);  // b cos(theta3)
    const double out = u - static_cast<double>(g_.a) * arm.cosine + static_cast<double>(g_.c);
    const double off = plate.x() - static_cast<double>(g_.a) * arm.sine;
    const double along =  // b sin(theta3)
        std::sqrt(out * out + off * off) - static_cast<double>(g_.d) - static_cast<double>(g_.e);
    const double b = static_cast<double>(g_.b);
    return side * side + along * along - b * b;
  }

  const core::DeltaGeometry& g_;
  std::array<SineCosine, core::kAxes> places_;  // of the legs around the base
  std::array<SineCosine, core::kAxes> arms_;
};

Vector3d five_bar_elbow(const core::FiveBarGeometry& g, const Vector3d& q, Eigen::Index i) {
  const Vector3d motor(0.0, (i == 0 ? -0.5 : 0.5) * static_cast<double>(g.base_m), 0.0);
  return motor + static_cast<double>(g.arm_m) * elevated(Vector3d::UnitY(), q[i]);
}

/// Closure error of both forearms of a five-bar, m2, and the distance from its plane, m, by the
/// position of its tip.
class FiveBarClosure {
 public:
  FiveBarClosure(const core::FiveBarGeometry& g, const Vector3d& q)
      : elbows_{five_bar_elbow(g, q, 0), five_bar_elbow(g, q, 1)},
        length_(static_cast<double>(g.forearm_m)) {}

  Vector3d operator()(const Vector3d& tip) const {
    return {(tip - elbows_[0]).squaredNorm() - length_ * length_,
            (tip - elbows_[1]).squaredNorm() - length_ * length_, tip.x()};
  }

 private:
  std::array<Vector3d, 2> elbows_;
  double length_;
};

/// Starting point of the search, far from the elbows on the side where the forearms meet.
Vector3d beyond_elbows(const core::FiveBarGeometry& g, const Vector3d& q) {
  const Vector3d first = five_bar_elbow(g, q, 0);
  const Vector3d across = five_bar_elbow(g, q, 1) - first;
  return first + 0.5 * across +
         2.0 * static_cast<double>(g.forearm_m) * Vector3d::UnitX().cross(across).normalized();
}

template <class Function>
Matrix3d gradient(const Function& function, const Vector3d& at) {
  Matrix3d result;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d step = kDifference * Vector3d::Unit(i);
    result.col(i) = (function(at + step) - function(at - step)) / (2.0 * kDifference);
  }
  return result;
}

/// Tip with which the Closure of a geometry and joints is zero, and its Jacobian. Newton's method
/// from the distant point `from`, which selects the solution on that side.
template <class Closure, class Geometry>
std::optional<LinkagePose> closed_pose(const Geometry& g, const Vector3d& q, const Vector3d& from) {
  const Closure misfit(g, q);
  LinkagePose pose;
  pose.tip_m = from;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vector3d step = gradient(misfit, pose.tip_m).inverse() * misfit(pose.tip_m);
    if (!step.allFinite()) {
      return std::nullopt;
    }
    pose.tip_m -= step;
    if (step.squaredNorm() <= kConverged_m * kConverged_m) {
      const auto by_joints = [&](const Vector3d& joints) { return Closure(g, joints)(pose.tip_m); };
      pose.jacobian = -gradient(misfit, pose.tip_m).inverse() * gradient(by_joints, q);
      return pose;
    }
  }
  return std::nullopt;
}

LinkagePose paddle_pose(double length_m, double q) {
  LinkagePose pose;
  pose.tip_m = length_m * elevated(Vector3d::UnitX(), q);
  pose.jacobian.col(0) = (-Vector3d::UnitY()).cross(pose.tip_m);
  return pose;
}

std::optional<LinkagePose> geometry_pose(const core::DeviceModel& m, const Vector3d& q) {
  switch (m.kind) {
    case core::DeviceKind::kCartesian:
      return LinkagePose{q, Matrix3d::Identity()};
    case core::DeviceKind::kArm:
      return arm_pose(m.arm, q);
    case core::DeviceKind::kDelta: {
      const double reach = static_cast<double>(m.delta.a + m.delta.b + m.delta.d + m.delta.e);
      return closed_pose<DeltaClosure>(m.delta, q, reach * Vector3d::UnitX());
    }
    case core::DeviceKind::kFiveBar: {
      auto pose = closed_pose<FiveBarClosure>(m.five_bar, q, beyond_elbows(m.five_bar, q));
      if (pose) {
        pose->jacobian.col(2).setZero();
      }
      return pose;
    }
    case core::DeviceKind::kPaddle:
      return paddle_pose(static_cast<double>(m.paddle_m), q[0]);
  }
  return std::nullopt;
}

/// Heights of the links' centres of mass in the frame of the geometry.
Vector3d centre_heights(const core::DeviceModel& m, const Vector3d& q) {
  Vector3d height = Vector3d::Zero();
  if (m.kind == core::DeviceKind::kArm) {
    const ArmPoints p = arm_points(m.arm, q);
    const double elbow = p.elbow.z();
    const double on_arm = static_cast<double>(m.link_centre_m[1]);
    const double on_forearm = static_cast<double>(m.link_centre_m[2]);
    height[1] = on_arm * elbow / static_cast<double>(m.arm.arm_m);
    height[2] = elbow + on_forearm * p.forearm.z();
  } else if (m.kind != core::DeviceKind::kCartesian) {
    for (std::uint32_t link = 0; link < core::axes_of(m.kind); ++link) {
      const double centre = static_cast<double>(m.link_centre_m[link]);
      const SineCosine arm = sine_cosine(q[link]);
      height[link] =
          m.kind == core::DeviceKind::kDelta
              ? centre * arm.cosine * sine_cosine(static_cast<double>(m.delta.leg_rad[link])).sine
              : centre * arm.sine;
    }
  }
  return height;
}

}  // namespace

std::optional<LinkagePose> Linkage::pose(const Vector3d& joints) const {
  std::optional<LinkagePose> pose = geometry_pose(model_, joints);
  if (pose) {
    pose->tip_m -= widen(model_.origin_m);
  }
  return pose;
}

Vector3d Linkage::joints_near(const Vector3d& tip_m) const {
  constexpr int kSteps = 200;
  constexpr double kDamping = 1e-6;  // relative to the squared Frobenius norm of the Jacobian
  Vector3d q = Vector3d::Zero();
  for (Eigen::Index i = 0; i < axes(); ++i) {
    const double middle =
        0.5 * (static_cast<double>(model_.joint_min[i]) + static_cast<double>(model_.joint_max[i]));
    q[i] = middle;
  }
  for (int step = 0; step < kSteps; ++step) {
    const std::optional<LinkagePose> here = pose(q);
    if (!here) {
      break;
    }
    const Matrix3d& jacobian = here->jacobian;
    Matrix3d normal = jacobian.transpose() * jacobian;
    normal.diagonal().array() += kDamping * normal.trace();
    Vector3d change = normal.inverse() * (jacobian.transpose() * (tip_m - here->tip_m));
    const double largest = change.cwiseAbs().maxCoeff();
    constexpr double kMaxStep = 0.2;  // rad or m; after a longer step the linkage may not close
    change *= largest > kMaxStep ? kMaxStep / largest : 1.0;
    const Vector3d before = q;
    for (Eigen::Index i = 0; i < axes(); ++i) {
      q[i] = std::clamp(q[i] + change[i], static_cast<double>(model_.joint_min[i]),
                        static_cast<double>(model_.joint_max[i]));
    }
    if (q == before) {
      break;
    }
  }
  return q;
}

double Linkage::links_potential_J(const Vector3d& joints) const {
  const Vector3d heights = centre_heights(model_, joints);
  double sum = 0.0;
  for (Eigen::Index link = 0; link < axes(); ++link) {
    sum += kGravity * static_cast<double>(model_.link_mass_kg[link]) * heights[link];
  }
  return sum;
}

double Linkage::potential_J(const Vector3d& joints) const {
  const double links = links_potential_J(joints);
  const std::optional<LinkagePose> here = pose(joints);
  return here ? links + kGravity * static_cast<double>(model_.tip_mass_kg) * here->tip_m.z()
              : links;
}

}  // namespace tactree::plant
