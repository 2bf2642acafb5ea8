#include "tactree/plant/linkage_shape.hpp"

#include <algorithm>

#include "tactree/plant/trigonometry.hpp"
#include "tactree/plant/vectors.hpp"

namespace tactree::plant {
namespace {

using Eigen::Vector3d;

double wide(float value) { return static_cast<double>(value); }

/// Displacement by `along` metres in the direction `angle_rad` above `forward`.
Vector3d reach(const Vector3d& forward, double angle_rad, double along) {
  const SineCosine a = sine_cosine(angle_rad);
  return along * (a.cosine * forward + a.sine * Vector3d::UnitZ());
}

Polyline arm(const core::ArmGeometry& g, const Vector3d& q, const Vector3d& tip) {
  const SineCosine turn = sine_cosine(q[0]);
  const Vector3d forward(turn.cosine, turn.sine, 0.0);
  return {Vector3d::Zero(), reach(forward, q[1], wide(g.arm_m)), tip};
}

/// Hinge on the ring, end of the arm, hinge on the plate, centre of the plate. The axes x, y, z of
/// Stamper's frame are y, z, x of the device.
Polyline delta_leg(const core::DeltaGeometry& g, double q, std::size_t leg, const Vector3d& plate) {
  const SineCosine place = sine_cosine(wide(g.leg_rad[leg]));
  const Vector3d outwards(0.0, place.cosine, place.sine);
  const Vector3d aside(0.0, -place.sine, place.cosine);
  const Vector3d hinge = wide(g.r) * outwards + wide(g.s) * aside;
  const SineCosine arm = sine_cosine(q);
  const Vector3d elbow = hinge + wide(g.a) * (arm.cosine * outwards + arm.sine * Vector3d::UnitX());
  return {hinge, elbow, plate + wide(g.c) * outwards + wide(g.f) * aside, plate};
}

Polyline five_bar_side(const core::FiveBarGeometry& g, double q, double side, const Vector3d& tip) {
  const Vector3d motor(0.0, 0.5 * side * wide(g.base_m), 0.0);
  return {motor, motor + reach(Vector3d::UnitY(), q, wide(g.arm_m)), tip};
}

Polyline rail(const core::DeviceModel& model, Eigen::Index axis, const Vector3d& tip) {
  Polyline line{tip, tip};
  line[0][axis] = std::max(tip[axis] - kDrawnRail_m, wide(model.joint_min[axis]));
  line[1][axis] = std::min(tip[axis] + kDrawnRail_m, wide(model.joint_max[axis]));
  return line;
}

/// The links in the frame of the geometry, not in the device frame.
std::vector<Polyline> geometry_shape(const core::DeviceModel& model, const Vector3d& q,
                                     const Vector3d& tip) {
  switch (model.kind) {
    case core::DeviceKind::kCartesian:
      return {rail(model, 0, tip), rail(model, 1, tip), rail(model, 2, tip)};
    case core::DeviceKind::kArm:
      return {arm(model.arm, q, tip)};
    case core::DeviceKind::kDelta:
      return {delta_leg(model.delta, q[0], 0, tip), delta_leg(model.delta, q[1], 1, tip),
              delta_leg(model.delta, q[2], 2, tip)};
    case core::DeviceKind::kFiveBar:
      return {five_bar_side(model.five_bar, q[0], -1.0, tip),
              five_bar_side(model.five_bar, q[1], 1.0, tip)};
    case core::DeviceKind::kPaddle:
      return {{Vector3d::Zero(), tip}};
  }
  return {};
}

}  // namespace

std::vector<Polyline> linkage_shape(const core::DeviceModel& model, const Vector3d& joints,
                                    const Vector3d& tip_m) {
  const Vector3d origin = widen(model.origin_m);
  std::vector<Polyline> shape = geometry_shape(model, joints, tip_m + origin);
  for (Polyline& line : shape) {
    for (Vector3d& point : line) {
      point -= origin;
    }
  }
  return shape;
}

}  // namespace tactree::plant
