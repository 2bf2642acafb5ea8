// No sound device gives a fault in 10^8 ticks: any script of the hand, and random hands that are
// guided into surfaces, along axes and into the ends of the ranges, on every device. Takes half an
// hour: ./test --release hands.

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;
using simulation::Waypoint;

constexpr std::uint64_t kTicksOfAll = 100'000'000;
constexpr double kSeconds = 20.0;  // of a session

const Shape& body(std::size_t number) {
  static const Shape shapes[] = {sphere(), cos_sheet(), sphere(0.04, 0.002)};
  return shapes[number % std::size(shapes)];
}

/// A session of one device, determined by its number.
class Session {
 public:
  Session(const core::DevicePreset& device, std::uint32_t number)
      : random_(number), shape_(body(number)) {
    simulation::use_device(device, setup_);
    setup_.controller.rate_hz = pick<float>({500.0F, 1000.0F, 4000.0F});
    core::limit_to_rate(setup_.controller);
    core::limit_force(setup_.controller, setup_.controller.limits.force_max_N);
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      const float most = 2.0F * setup_.controller.motors.effort_max[axis];
      float& slew = setup_.controller.motors.effort_slew_s[axis];
      slew = std::min(slew, most * setup_.controller.rate_hz);
    }
    const float stiffest = core::stability_limit(setup_.controller).with_hand_N_m;
    setup_.controller.contact.stiffness_N_m = pick<float>({0.2F, 0.5F, 0.7F}) * stiffest;
    setup_.controller.use_materials = false;
    setup_.plant.hand.stiffness_N_m = pick<double>({150.0, 300.0, 1000.0});
  }

  /// The faults, by name and tick; empty if there are none.
  std::string faults(std::uint64_t& ticks) {
    simulation::Simulation sim(shape_.bytes(), setup_, path());
    EXPECT_TRUE(sim.start_result().ok()) << describe(sim.start_result());
    EXPECT_TRUE(sim.arm());
    std::string names;
    core::FaultMask known = 0;
    while (sim.time_s() < kSeconds && known == 0U) {
      const core::Status status = sim.step().status;
      ++ticks;
      for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
        const auto fault = static_cast<core::Fault>(code);
        if (core::has_fault(status.faults, fault)) {
          names += std::string(core::name_of(fault)) + " at tick " + std::to_string(status.tick);
        }
      }
      known = status.faults;
    }
    return names;
  }

 private:
  template <class T>
  T pick(std::vector<T> of) {
    return of[std::uniform_int_distribution<std::size_t>(0, of.size() - 1)(random_)];
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  HandPath path() {
    if (between(0.0, 1.0) < 0.2) {
      return simulation::make_script(pick(simulation::script_names()), shape_.view(), kSeconds);
    }
    const double box = pick<double>({0.06, 0.12, 0.3});  // the last is beyond every range
    const double speed = pick<double>({0.03, 0.1, 0.4});
    std::vector<Waypoint> waypoints{{0.0, {0.0, 0.0, 0.06}}};
    while (waypoints.back().t_s < kSeconds) {
      const Waypoint last = waypoints.back();
      Eigen::Vector3d next(between(-box, box), between(-box, box), between(-box, box));
      if (between(0.0, 1.0) < 0.4) {  // along one axis, as if on rails
        const int axis = pick<int>({0, 1, 2, 2});
        const double to = next[axis];
        next = last.position_m;
        next[axis] = to;
      }
      const double way = (next - last.position_m).norm();
      waypoints.push_back({last.t_s + std::max(0.05, way / (speed * between(0.5, 2.0))), next});
      if (between(0.0, 1.0) < 0.3) {  // rests, often against a stop or in a surface
        waypoints.push_back({waypoints.back().t_s + between(0.05, 1.0), next});
      }
    }
    return HandPath(waypoints);
  }

  std::mt19937 random_;
  const Shape& shape_;
  simulation::Setup setup_;
};

class RandomHands : public testing::TestWithParam<core::DevicePreset> {};

TEST_P(RandomHands, GiveNoFault) {
  std::uint64_t ticks = 0;
  std::uint32_t sessions = 0;
  while (ticks < kTicksOfAll / std::size(core::kDevicePresets)) {
    EXPECT_EQ(Session(GetParam(), sessions).faults(ticks), "") << "session " << sessions;
    ++sessions;
  }
  RecordProperty("ticks", std::to_string(ticks));
}

INSTANTIATE_TEST_SUITE_P(Device, RandomHands, testing::ValuesIn(core::kDevicePresets),
                         [](const auto& device) { return std::string(device.param.name); });

}  // namespace
}  // namespace tactree::test
