// No sound device gives a fault in 10^8 ticks: any script of the hand, and random hands that are
// guided into surfaces, along axes and into the ends of the ranges, on every device. Takes half an
// hour: ./test --hands.

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/simulation.hpp"
#include "tactree/simulation/workspace.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;
using simulation::Waypoint;

constexpr std::uint64_t kTicksOfAll = 100'000'000;
constexpr double kSeconds = 20.0;  // of a session
constexpr double kFar_m = 0.3;     // beyond the range of every device with an end
// Most that a person pulls or pushes with. 150 N throw a light device faster than speed_max_m_s
// when it comes free from the end of a range, which is rightly a fault.
constexpr double kPull_N = 30.0;
constexpr double kWeight_N = 5.0;  // of the heaviest device, at its probe

/// One that the probe can touch from above, where every session begins.
const Shape& body(std::size_t number, const core::DeviceModel& device) {
  static const Shape shapes[] = {sphere(), cos_sheet(), box(0.025), sphere(0.04, 0.002)};
  const bool reaches_all = simulation::reaches(device, {0.0, 0.0, 0.045});
  return shapes[number % (std::size(shapes) - (reaches_all ? 0U : 1U))];
}

// Ticks for each position that is compared with the reach, which takes longer than many ticks.
constexpr std::uint64_t kPlaces = 2000;

/// What the hands of the sessions have done.
struct Counts {
  std::uint64_t ticks = 0;
  std::uint64_t in_contact = 0;
  std::uint64_t places = 0;   // one in kPlaces ticks
  std::uint64_t at_ends = 0;  // of these places, those at the ends of the ranges
};

/// A session of one device, determined by its number.
class Session {
 public:
  Session(const core::DevicePreset& device, std::uint32_t number)
      : random_(number), shape_(body(number, device.model)) {
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
  std::string faults(Counts& counts) {
    const HandPath hand = path();
    simulation::Simulation sim(shape_.bytes(), setup_, hand);
    EXPECT_TRUE(sim.start_result().ok()) << describe(sim.start_result());
    sim.steer(carried(hand.at(0.0)));
    EXPECT_TRUE(sim.arm());
    std::string names;
    core::FaultMask known = 0;
    while (sim.time_s() < kSeconds && known == 0U) {
      sim.steer(held(hand.at(sim.time_s()), sim.plant().position_m()));
      const core::Status status = sim.step().status;
      ++counts.ticks;
      counts.in_contact += status.rendering.in_contact ? 1U : 0U;
      if (counts.ticks % kPlaces == 0U) {
        const core::DeviceModel& device = setup_.controller.device;
        ++counts.places;
        counts.at_ends += simulation::reaches(device, sim.plant().position_m()) ? 0U : 1U;
      }
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

  /// The hand that holds the device before its motors do: higher by what it gives way, so that the
  /// probe does not rest on the body, where the controller waits.
  plant::HandTarget carried(plant::HandTarget start) const {
    start.position_m.z() += kWeight_N / setup_.plant.hand.stiffness_N_m;
    return start;
  }

  /// The hand on its path, which stays behind where it would pull with more than kPull_N.
  plant::HandTarget held(plant::HandTarget target, const Eigen::Vector3d& probe_m) const {
    const Eigen::Vector3d lead = target.position_m - probe_m;
    const double longest = kPull_N / setup_.plant.hand.stiffness_N_m;
    if (lead.norm() > longest) {
      target.position_m = probe_m + longest * lead.normalized();
    }
    return target;
  }

  HandPath path() {
    if (between(0.0, 1.0) < 0.2) {
      return simulation::make_script(pick(simulation::script_names()), shape_.view(), kSeconds);
    }
    const double box = pick<double>({0.06, 0.12, kFar_m});
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
  Counts counts;
  std::uint32_t sessions = 0;
  while (counts.ticks < kTicksOfAll / std::size(core::kDevicePresets)) {
    EXPECT_EQ(Session(GetParam(), sessions).faults(counts), "") << "session " << sessions;
    ++sessions;
  }
  EXPECT_GT(counts.in_contact, counts.ticks / 20);
  if (!simulation::reaches(GetParam().model, {kFar_m, kFar_m, kFar_m})) {
    EXPECT_GT(counts.at_ends, counts.places / 100);
  }
  RecordProperty("ticks", std::to_string(counts.ticks));
  RecordProperty("in_contact", std::to_string(counts.in_contact));
  RecordProperty("at_ends", std::to_string(counts.at_ends));
}

INSTANTIATE_TEST_SUITE_P(Device, RandomHands, testing::ValuesIn(core::kDevicePresets),
                         [](const auto& device) { return std::string(device.param.name); });

}  // namespace
}  // namespace tactree::test
