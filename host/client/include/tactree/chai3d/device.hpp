#pragma once
// A Tactree board as a haptic device of CHAI3D (https://www.chai3d.org), version 3: see
// docs/CHAI3D.md. The classes of CHAI3D are template parameters, so this header includes none of
// its headers.
//
//   using TactreeDevice = tactree::chai3d::Device<chai3d::cGenericHapticDevice, chai3d::cVector3d,
//                                                 chai3d::cMatrix3d>;
//   auto device = std::make_shared<TactreeDevice>("/dev/ttyACM0");
//
// Tactree and CHAI3D have the same axes: x to the user, y to the user's right, z up.

#include <memory>
#include <string>
#include <utility>

#include "tactree/client/board.hpp"
#include "tactree/client/link_error.hpp"

namespace tactree::chai3d {

struct DeviceOptions {
  unsigned baud = client::kUsualBaud;
  /// The force ends if this program does not run for that long.
  std::uint16_t link_timeout_ms = 50;
  std::uint32_t every_ticks = 1;  ///< telemetry interval; at least 10 on a serial port
  std::uint32_t force_ms = 20;    ///< duration of a force unless the next one replaces it
};

template <class Base, class Vector, class Matrix>
class Device : public Base {
 public:
  explicit Device(std::string port, const DeviceOptions& options = {})
      : port_(std::move(port)), options_(options) {
    this->m_deviceReady = false;
    this->m_deviceAvailable = true;
    this->m_specifications.m_modelName = "Tactree";
    this->m_specifications.m_sensedPosition = true;
    this->m_specifications.m_sensedRotation = false;
    this->m_specifications.m_actuatedPosition = true;
    this->m_specifications.m_actuatedRotation = false;
  }

  /// Waits for the board, and until the user holds its dead-man control. error() returns the reason
  /// for a failure.
  bool open() override {
    try {
      board_ = std::make_unique<client::Board>(
          port_, client::BoardOptions{options_.baud, options_.link_timeout_ms});
      const core::wire::CapabilitiesReply can = board_->capabilities();
      this->m_specifications.m_maxLinearForce = static_cast<double>(can.host_force_max_N);
      this->m_specifications.m_maxLinearStiffness = static_cast<double>(can.stiffness_limit_N_m);
      board_->subscribe({0x0F, options_.every_ticks});  // state, probe, velocity, force
      board_->arm();
    } catch (const client::LinkError& error) {
      error_ = error.what();
      board_.reset();
    }
    this->m_deviceReady = board_ != nullptr;
    return this->m_deviceReady;
  }

  bool close() override {
    board_.reset();  // stops the board
    this->m_deviceReady = false;
    return true;
  }

  /// Precondition: the device is in its home pose.
  bool calibrate(bool /*a_forceCalibration*/ = false) override {
    if (board_ == nullptr) {
      return false;
    }
    try {
      board_->home();
    } catch (const client::LinkError& error) {
      error_ = error.what();
      return false;
    }
    return true;
  }

  bool getPosition(Vector& a_position) override {
    if (board_ == nullptr) {
      return false;
    }
    const client::Telemetry latest = board_->latest();
    a_position.set(static_cast<double>(latest.probe_m[0]), static_cast<double>(latest.probe_m[1]),
                   static_cast<double>(latest.probe_m[2]));
    this->estimateLinearVelocity(a_position);
    return true;
  }

  bool getRotation(Matrix& a_rotation) override {
    a_rotation.identity();
    return board_ != nullptr;
  }

  bool getUserSwitches(unsigned int& a_userSwitches) override {
    a_userSwitches = 0;
    return board_ != nullptr;
  }

  /// The force is added to the contact force of the board's model. Torques are not displayed.
  bool setForceAndTorqueAndGripperForce(const Vector& a_force, const Vector& /*a_torque*/,
                                        double /*a_gripperForce*/) override {
    if (board_ == nullptr || !board_->in_session()) {
      return false;
    }
    this->m_prevForce = a_force;
    board_->add_force({static_cast<float>(a_force.x()), static_cast<float>(a_force.y()),
                       static_cast<float>(a_force.z())},
                      options_.force_ms);
    return true;
  }

  [[nodiscard]] const std::string& error() const { return error_; }
  /// Access to functions that CHAI3D does not have; nullptr while closed.
  [[nodiscard]] client::Board* board() { return board_.get(); }

 private:
  std::string port_;
  DeviceOptions options_;
  std::unique_ptr<client::Board> board_;
  std::string error_;
};

}  // namespace tactree::chai3d
