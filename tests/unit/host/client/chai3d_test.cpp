// The adapter for CHAI3D, with classes that have the members it uses, by the names of version 3.

#include <gtest/gtest.h>

#include "running_board.hpp"
#include "tactree/chai3d/device.hpp"

namespace tactree::test {
namespace {

class Vector {
 public:
  void set(double x, double y, double z) {
    x_ = x;
    y_ = y;
    z_ = z;
  }
  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] double y() const { return y_; }
  [[nodiscard]] double z() const { return z_; }

 private:
  double x_ = 0.0;
  double y_ = 0.0;
  double z_ = 0.0;
};

struct Matrix {
  bool is_identity = false;
  void identity() { is_identity = true; }
};

struct Specifications {
  std::string m_modelName;
  double m_maxLinearForce = 0.0;
  double m_maxLinearStiffness = 0.0;
  bool m_sensedPosition = false;
  bool m_sensedRotation = true;
  bool m_actuatedPosition = false;
  bool m_actuatedRotation = true;
};

class GenericHapticDevice {
 public:
  virtual ~GenericHapticDevice() = default;
  virtual bool open() { return false; }
  virtual bool close() { return false; }
  virtual bool calibrate(bool a_forceCalibration = false) { return a_forceCalibration; }
  virtual bool getPosition(Vector&) { return false; }
  virtual bool getRotation(Matrix&) { return false; }
  virtual bool getUserSwitches(unsigned int&) { return false; }
  virtual bool setForceAndTorqueAndGripperForce(const Vector&, const Vector&, double) {
    return false;
  }

  Specifications m_specifications;
  bool m_deviceReady = false;
  bool m_deviceAvailable = false;
  Vector m_prevForce;

 protected:
  void estimateLinearVelocity(Vector&) { ++estimates_; }
  int estimates_ = 0;
};

using Device = chai3d::Device<GenericHapticDevice, Vector, Matrix>;

TEST(Chai3d, ReadsPositionAndAppliesForce) {
  const RunningBoard running;
  chai3d::DeviceOptions options;
  Device device(running.port(), options);
  GenericHapticDevice& generic = device;
  Vector position;
  EXPECT_FALSE(generic.getPosition(position));
  ASSERT_TRUE(generic.open()) << device.error();
  EXPECT_TRUE(generic.m_deviceReady);
  EXPECT_EQ(generic.m_specifications.m_maxLinearForce, 4.0);
  const client::Connection& connection = device.board()->connection();
  EXPECT_TRUE(comes_true(connection, [&] {
    return generic.getPosition(position) && position.z() > 0.03 && position.z() < 0.05;
  }));
  Matrix rotation;
  EXPECT_TRUE(generic.getRotation(rotation) && rotation.is_identity);
  unsigned int switches = 1;
  EXPECT_TRUE(generic.getUserSwitches(switches));
  EXPECT_EQ(switches, 0U);
  Vector push;
  push.set(0.0, 1.0, 0.0);
  EXPECT_TRUE(comes_true(connection, [&] {
    (void)generic.setForceAndTorqueAndGripperForce(push, {}, 0.0);
    return device.board()->latest().force_N[1] > 0.5F;
  }));
  EXPECT_FALSE(generic.calibrate());  // not while armed
  EXPECT_TRUE(generic.close());
  EXPECT_FALSE(generic.setForceAndTorqueAndGripperForce(push, {}, 0.0));
}

TEST(Chai3d, ReportsFailureCause) {
  Device device("/dev/no-such-port");
  EXPECT_FALSE(device.open());
  EXPECT_NE(device.error().find("/dev/no-such-port"), std::string::npos);
}

}  // namespace
}  // namespace tactree::test
