#include "device_fields.hpp"

namespace tactree::support {
namespace {

constexpr std::uint32_t bit(core::DeviceKind kind) {
  return 1U << static_cast<std::uint32_t>(kind);
}

constexpr std::uint32_t kCartesianOnly = bit(core::DeviceKind::kCartesian);
constexpr std::uint32_t kArmOnly = bit(core::DeviceKind::kArm);
constexpr std::uint32_t kDeltaOnly = bit(core::DeviceKind::kDelta);
constexpr std::uint32_t kFiveBarOnly = bit(core::DeviceKind::kFiveBar);
constexpr std::uint32_t kPaddleOnly = bit(core::DeviceKind::kPaddle);
constexpr std::uint32_t kAnyKind = (1U << core::kDeviceKinds) - 1U;
constexpr std::uint32_t kTurning = kAnyKind & ~kCartesianOnly;

constexpr float kTravel_m = 1e12F;
constexpr float kTravel_rad = 100.0F;
constexpr std::optional<float> kRequired = std::nullopt;

constexpr DeviceText kTexts[] = {
    {"$schema", "this schema, for editors", {}, false, nullptr, nullptr},
    {"name", "name of the device", {}, false, nullptr, nullptr},
    {"about", "description of the device", {}, false, "", nullptr},
    {"kind", "mechanism", kKindNames, true, nullptr, nullptr},
    {"homing", "method that relates encoder counts to positions after power-up", kHomingNames,
     false, "given-pose", "the user holds the device in its home pose and sends the command"},
};

// The member of DevicePreset, as text and as pointers to its values.
#define TACTREE_FIELD(shape, member, ...) \
#member, [](core::DevicePreset & d) -> DeviceValues { return {__VA_ARGS__}; }, DeviceShape::shape
#define TACTREE_ONE(member) TACTREE_FIELD(kOne, member, &d.member, nullptr, nullptr)
#define TACTREE_AXES(member) TACTREE_FIELD(kAxes, member, &d.member[0], &d.member[1], &d.member[2])
#define TACTREE_VECTOR(member) TACTREE_FIELD(kVector, member, &d.member.x, &d.member.y, &d.member.z)

// In the order in which device files are written. The ranges are those of core::is_valid().
constexpr DeviceField kFields[] = {
    {"counts_per_m", kCartesianOnly, TACTREE_AXES(model.counts_per_m), 1.0F, 1e9F, 0.0F,
     "encoder counts (all edges) per metre of travel", kRequired, nullptr},
    {"arm_m", kArmOnly, TACTREE_ONE(model.arm.arm_m), 0.01F, 10.0F, 0.0F, "shoulder to elbow, m",
     kRequired, nullptr},
    {"forearm_m", kArmOnly, TACTREE_ONE(model.arm.forearm_m), 0.01F, 10.0F, 0.0F,
     "elbow to probe, m", kRequired, nullptr},
    {"coupling", kArmOnly, TACTREE_ONE(model.arm.coupling), 0.0F, 1.0F, 0.0F,
     "reference of joint 2: 0 is the vertical (parallelogram, motor on the base), 1 the arm",
     kRequired, nullptr},
    {"a_m", kDeltaOnly, TACTREE_ONE(model.delta.a), 1e-3F, 1.0F, 0.0F, "length of an arm, m",
     kRequired, nullptr},
    {"b_m", kDeltaOnly, TACTREE_ONE(model.delta.b), 1e-3F, 1.0F, 0.0F,
     "long side of the parallelogram, m", kRequired, nullptr},
    {"c_m", kDeltaOnly, TACTREE_ONE(model.delta.c), -1.0F, 1.0F, 0.0F,
     "from the centre of the plate to its hinges, m", kRequired, nullptr},
    {"d_m", kDeltaOnly, TACTREE_ONE(model.delta.d), 0.0F, 1.0F, 0.0F,
     "from the end of the arm to the parallelogram, m", kRequired, nullptr},
    {"e_m", kDeltaOnly, TACTREE_ONE(model.delta.e), 0.0F, 1.0F, 0.0F,
     "from the parallelogram to the plate, m", kRequired, nullptr},
    {"f_m", kDeltaOnly, TACTREE_ONE(model.delta.f), -1.0F, 1.0F, 0.0F,
     "offset of the end of the parallelogram along the hinge, m", kRequired, nullptr},
    {"r_m", kDeltaOnly, TACTREE_ONE(model.delta.r), -1.0F, 1.0F, 0.0F,
     "from the centre of the ring to the joints of the arms, m", kRequired, nullptr},
    {"s_m", kDeltaOnly, TACTREE_ONE(model.delta.s), -1.0F, 1.0F, 0.0F,
     "offset of the arms along their joints, m", kRequired, nullptr},
    {"leg_rad", kDeltaOnly, TACTREE_AXES(model.delta.leg_rad), -core::kTwoPi, core::kTwoPi, 0.0F,
     "position of each arm on the ring, rad", kRequired, nullptr},
    {"arm_m", kFiveBarOnly, TACTREE_ONE(model.five_bar.arm_m), 1e-3F, 10.0F, 0.0F,
     "motor to elbow, m", kRequired, nullptr},
    {"forearm_m", kFiveBarOnly, TACTREE_ONE(model.five_bar.forearm_m), 1e-3F, 10.0F, 0.0F,
     "elbow to probe, m", kRequired, nullptr},
    {"base_m", kFiveBarOnly, TACTREE_ONE(model.five_bar.base_m), 0.0F, 10.0F, 0.0F,
     "distance of the motors, m", kRequired, nullptr},
    {"paddle_m", kPaddleOnly, TACTREE_ONE(model.paddle_m), 1e-3F, 10.0F, 0.0F, "pivot to probe, m",
     kRequired, nullptr},
    {"counts_per_revolution", kTurning, TACTREE_AXES(model.counts_per_revolution), 1.0F, 1e7F, 0.0F,
     "encoder counts (all edges) per revolution of the motor", kRequired, nullptr},
    {"ratio", kCartesianOnly, TACTREE_AXES(model.ratio), -1e5F, 1e5F, 1e-3F,
     "rad of the motor per metre, for currents; negative for opposite directions", kRequired,
     nullptr},
    {"ratio", kTurning, TACTREE_AXES(model.ratio), -1e5F, 1e5F, 1e-3F,
     "revolutions of the motor per revolution of the joint, negative for opposite directions",
     kRequired, nullptr},
    {"home_position", kCartesianOnly, TACTREE_AXES(model.home_position), -kTravel_m, kTravel_m,
     0.0F, "position of each axis after homing, m, within its range", kRequired, nullptr},
    {"home_position", kTurning, TACTREE_AXES(model.home_position), -kTravel_rad, kTravel_rad, 0.0F,
     "position of each joint after homing, rad, within its range", kRequired, nullptr},
    {"joint_min", kCartesianOnly, TACTREE_AXES(model.joint_min), -kTravel_m, kTravel_m, 0.0F,
     "lower end of the range of each axis, m, below joint_max", kRequired, nullptr},
    {"joint_min", kTurning, TACTREE_AXES(model.joint_min), -kTravel_rad, kTravel_rad, 0.0F,
     "lower end of the range of each joint, rad, below joint_max", kRequired, nullptr},
    {"joint_max", kCartesianOnly, TACTREE_AXES(model.joint_max), -kTravel_m, kTravel_m, 0.0F,
     "upper end of the range of each axis, m", kRequired, nullptr},
    {"joint_max", kTurning, TACTREE_AXES(model.joint_max), -kTravel_rad, kTravel_rad, 0.0F,
     "upper end of the range of each joint, rad", kRequired, nullptr},
    {"joint_margin", kCartesianOnly, TACTREE_AXES(model.joint_margin), 0.0F, kTravel_m, 0.0F,
     "distance from an end of the range over which the force fades, m, at most half of the range",
     kRequired, nullptr},
    {"joint_margin", kTurning, TACTREE_AXES(model.joint_margin), 0.0F, kTravel_rad, 0.0F,
     "distance from an end of the range over which the force fades, rad, at most half of the range",
     kRequired, nullptr},
    {"origin_m", kCartesianOnly, TACTREE_VECTOR(model.origin_m), -10.0F, 10.0F, 0.0F,
     "origin of the device frame (x to the user, y to the user's right, z up) in the frame of the "
     "axes, m",
     0.0F, "the probe is at the origin if all axes are at 0"},
    {"origin_m", kTurning, TACTREE_VECTOR(model.origin_m), -10.0F, 10.0F, 0.0F,
     "origin of the device frame (x to the user, y to the user's right, z up) in the frame of the "
     "mechanism, m",
     kRequired, nullptr},
    {"link_mass_kg", kAnyKind, TACTREE_AXES(model.link_mass_kg), 0.0F, 100.0F, 0.0F,
     "mass of each link for gravity compensation, kg", 0.0F,
     "the weight of the links is not compensated"},
    {"link_centre_m", kAnyKind, TACTREE_AXES(model.link_centre_m), -10.0F, 10.0F, 0.0F,
     "centre of mass along each link, measured from its joint, m; negative behind the joint", 0.0F,
     "the weight of the links is not compensated"},
    {"tip_mass_kg", kAnyKind, TACTREE_ONE(model.tip_mass_kg), 0.0F, 100.0F, 0.0F,
     "mass that moves with the probe, kg", 0.0F, "the weight of the probe is not compensated"},
    {"torque_constant_Nm_per_ampere", kAnyKind, TACTREE_AXES(model.torque_constant_Nm_per_ampere),
     1e-6F, 1e3F, 0.0F, "torque constant of each motor, Nm/A", kRequired, nullptr},
    {"force_max_N", kAnyKind, TACTREE_ONE(drive.force_max_N), 0.01F, 1e3F, 0.0F,
     "maximum force at the probe, N", kRequired, nullptr},
    {"effort_max", kAnyKind, TACTREE_AXES(drive.effort_max), 1e-4F, 1e3F, 0.0F,
     "maximum effort of each axis, N or Nm", kRequired, nullptr},
    {"damping_Ns_m", kAnyKind, TACTREE_ONE(drive.damping_Ns_m), 0.0F, 1e3F, 0.0F,
     "minimum viscous damping of the device at the probe, Ns/m, for the stability limit", 0.0F,
     "the lowest stability limit"},
    {"inertia", kAnyKind, TACTREE_AXES(dynamics.inertia), 1e-9F, 1e3F, 0.0F,
     "inertia of each axis with its motor, without the tip, kg or kg m2; for simulations only",
     kRequired, nullptr},
    {"viscous", kAnyKind, TACTREE_AXES(dynamics.viscous), 0.0F, 1e3F, 0.0F,
     "viscous friction of each axis, Ns/m or Nms; for simulations only", 0.0F,
     "simulated without it"},
    {"coulomb", kAnyKind, TACTREE_AXES(dynamics.coulomb), 0.0F, 1e3F, 0.0F,
     "dry friction of each axis, N or Nm; for simulations only", 0.0F, "simulated without it"},
};

#undef TACTREE_FIELD
#undef TACTREE_ONE
#undef TACTREE_AXES
#undef TACTREE_VECTOR

}  // namespace

std::span<const DeviceText> device_texts() { return kTexts; }

std::span<const DeviceField> device_fields() { return kFields; }

}  // namespace tactree::support
