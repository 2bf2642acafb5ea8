#pragma once
// The parameters of a device: encoders, transmission, geometry, joint ranges, masses.
// Presets: device_presets.hpp. Conversion of counts to the probe position: kinematics.hpp.
//
// Device frame: x towards the user, y to the user's right, z up.
//
// Interrupt safety: plain data and pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/math/angle.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kAxes = 3;

enum class DeviceKind : std::uint8_t {
  kCartesian = 0,  ///< three linear axes along x, y and z
  kArm,            ///< a base that turns about z, an arm, a forearm: serial 3R or parallelogram
  kDelta,          ///< three arms on a ring, each with a parallelogram to a central plate
  kFiveBar,        ///< two arms and two forearms in the vertical plane y-z; axis 2 is unused
  kPaddle,         ///< one lever in the vertical plane x-z; axes 1 and 2 are unused
};
inline constexpr std::uint32_t kDeviceKinds = 5;

/// Method that relates encoder counts to joint positions after power-up (homing.hpp).
enum class HomingMethod : std::uint8_t {
  kAbsolute = 0,  ///< absolute encoders: home_count is valid at power-up
  kGivenPose,     ///< the user holds every joint at its home position and sends the command
  kIndex,         ///< each joint passes the index pulse at its home position
  kHardStop,      ///< the user moves each joint from stop to stop
};
inline constexpr std::uint32_t kHomingMethods = 4;

/// kArm. Joint 0: rotation of the base about z. Joint 1: elevation of the arm above the horizontal.
/// Joint 2: swing of the forearm. Its angle outwards from hanging is joint 2 + coupling * joint 1.
struct ArmGeometry {
  float arm_m = 0.2F;      ///< shoulder to elbow: 0.01 .. 10
  float forearm_m = 0.2F;  ///< elbow to probe: 0.01 .. 10
  /// Reference of joint 2: 0 .. 1. With 0 it is the vertical (parallelogram, motor on the base),
  /// with 1 the arm (motor on the arm).
  float coupling = 0.0F;
};

/// kDelta, with the symbols of R. E. Stamper, "A three degree of freedom parallel manipulator with
/// only translational degrees of freedom", PhD thesis, University of Maryland, 1997. Lengths in m:
/// a and b 0.001 .. 1, d and e 0 .. 1, the others within +-1. Joints: elevation of each arm above
/// the plane of the ring.
struct DeltaGeometry {
  float a = 0.06F;    ///< arm
  float b = 0.1025F;  ///< long side of the parallelogram
  float c = 0.0F;     ///< from the centre of the plate to its hinges
  float d = 0.0F;     ///< from the arm's end to the parallelogram
  float e = 0.0F;     ///< from the parallelogram to the plate
  float f = 0.0F;     ///< offset of the parallelogram's end along the hinge
  float r = 0.04F;    ///< from the centre of the ring to the joints of the arms
  float s = 0.0F;     ///< offset of the arms along their joints
  float leg_rad[kAxes] = {0.0F, 2.0943951F, -2.0943951F};  ///< position on the ring: +-2 pi
};

/// kFiveBar. Joint 0: angle of the arm on the -y side. Joint 1: angle of the arm on the +y side.
/// Both are measured from +y towards +z.
struct FiveBarGeometry {
  float arm_m = 0.05F;      ///< motor to elbow: 0.001 .. 10
  float forearm_m = 0.07F;  ///< elbow to probe: 0.001 .. 10
  float base_m = 0.02F;     ///< between the motors: 0 .. 10
};

/// Parameters of a device. `kind` selects the geometry. Joint positions are in rad, or in m for
/// kCartesian.
struct DeviceModel {
  DeviceKind kind = DeviceKind::kCartesian;
  /// A controller arms only after homing. kAbsolute is a statement about the encoders: with others,
  /// the position at power-up would be taken for home_position.
  HomingMethod homing = HomingMethod::kGivenPose;

  // joint = home_position + (count - home_count) / counts_per_unit()
  /// kCartesian: encoder counts per metre of travel: 1 .. 1e9.
  float counts_per_m[kAxes] = {33333.3F, 33333.3F, 33333.3F};
  /// All other kinds: encoder counts (all edges) per revolution of the motor: 1 .. 1e7.
  float counts_per_revolution[kAxes] = {4096.0F, 4096.0F, 4096.0F};
  /// Revolutions of the motor per revolution of the joint, negative for opposite directions.
  /// kCartesian: motor rad per metre, used only for currents. Absolute value: 1e-3 .. 1e5.
  float ratio[kAxes] = {1.0F, 1.0F, 1.0F};
  std::int32_t home_count[kAxes] = {0, 0, 0};
  float home_position[kAxes] = {0.0F, 0.0F, 0.0F};  ///< within the joint's range
  /// Mechanical range of each joint, min < max, within +-1e12 (m) or +-100 (rad).
  float joint_min[kAxes] = {-1e12F, -1e12F, -1e12F};
  float joint_max[kAxes] = {1e12F, 1e12F, 1e12F};
  /// The force fades over this distance from each end of the range; 0: no fading. A position
  /// outside the range by more than this distance is an encoder error. 0 .. (max - min) / 2.
  float joint_margin[kAxes] = {0.0F, 0.0F, 0.0F};

  ArmGeometry arm{};
  DeltaGeometry delta{};
  FiveBarGeometry five_bar{};
  float paddle_m = 0.07F;  ///< kPaddle, pivot to probe: 0.001 .. 10. Joint: elevation.
  /// Origin of the device frame in the frame of the geometry, within +-10 m. The geometry's own
  /// origin is on the axis of joint 0; kArm: at the height of the shoulder; kDelta: at the centre
  /// of the ring; kFiveBar: midway between the motors.
  Vec3 origin_m{};

  // For gravity compensation. A centre of mass is measured along the link from its joint; it is
  // negative behind the joint, e.g. for a counterweight. kArm: link 1 is the arm, 2 the forearm.
  // kDelta, kFiveBar: a link is an arm with half of its forearm. kPaddle: link 0. kCartesian: none.
  float link_mass_kg[kAxes] = {0.0F, 0.0F, 0.0F};   ///< 0 .. 100
  float link_centre_m[kAxes] = {0.0F, 0.0F, 0.0F};  ///< within +-10
  float tip_mass_kg = 0.0F;                         ///< moves with the probe: 0 .. 100

  /// Torque constant of each motor: 1e-6 .. 1000.
  float torque_constant_Nm_per_ampere[kAxes] = {0.025F, 0.025F, 0.025F};
};

/// Number of axes: 3, 2 or 1. Inputs of unused axes are ignored, and their effort is 0.
[[nodiscard]] constexpr std::uint32_t axes_of(DeviceKind kind) {
  return kind == DeviceKind::kPaddle ? 1U : (kind == DeviceKind::kFiveBar ? 2U : kAxes);
}

/// The first parameter used by the kind that is not finite or not within its range.
struct DeviceRefusal {
  const char* field = nullptr;  ///< "device.ratio"; nullptr: every parameter is valid
  float value = 0.0F;           ///< of a ratio: its absolute value
  float min = 0.0F;             ///< with the other values as they are
  float max = 0.0F;
  std::int32_t axis = -1;  ///< of a field with one value per axis; else -1
};

/// Checks every parameter used by the kind. Cost: constant.
[[nodiscard]] DeviceRefusal refusal_of(const DeviceModel& device);
[[nodiscard]] inline bool is_valid(const DeviceModel& device) {
  return refusal_of(device).field == nullptr;
}

/// Encoder counts per unit of the joint (1/m or 1/rad); negative for opposite directions.
/// Precondition: is_valid(device), axis < kAxes.
[[nodiscard]] constexpr float counts_per_unit(const DeviceModel& device, std::uint32_t axis) {
  return device.kind == DeviceKind::kCartesian
             ? device.counts_per_m[axis]
             : device.counts_per_revolution[axis] * device.ratio[axis] / kTwoPi;
}

}  // namespace tactree::core
