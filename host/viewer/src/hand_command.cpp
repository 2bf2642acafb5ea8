#include "hand_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "contact_parameters.hpp"
#include "steered_hand.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxVia = 64;

Eigen::Vector3d place_of(const std::string& name, const json& value) {
  constexpr double kMaxDistance_m = 10.0;
  if (!value.is_array() || value.size() != 3) {
    throw SessionRefused(name + ": not an array of three numbers");
  }
  Eigen::Vector3d place;
  for (std::size_t i = 0; i < 3; ++i) {
    place[static_cast<Eigen::Index>(i)] = static_cast<double>(number_of(name, value[i]));
  }
  if (!place.allFinite() || place.cwiseAbs().maxCoeff() > kMaxDistance_m) {
    throw SessionRefused(fmt::format("{}: outside +-{} m", name, kMaxDistance_m));
  }
  return place;
}

}  // namespace

std::vector<Eigen::Vector3d> path_of(const json& command) {
  const json via = command.value("via_m", json::array());
  if (!via.is_array() || via.size() > kMaxVia) {
    throw SessionRefused(fmt::format("via_m: not an array of at most {} positions", kMaxVia));
  }
  std::vector<Eigen::Vector3d> path;
  for (const json& place : via) {
    path.push_back(place_of("via_m", place));
  }
  path.push_back(place_of("target_m", command.value("target_m", json())));
  return path;
}

double speed_of(const json& command) {
  if (!command.contains("speed_m_s")) {
    return SteeredHand::kFastest_m_s;
  }
  const auto speed = static_cast<double>(number_of("speed_m_s", command["speed_m_s"]));
  if (!(speed > 0.0 && speed <= SteeredHand::kFastest_m_s)) {
    throw SessionRefused(fmt::format("speed_m_s: outside 0 .. {}", SteeredHand::kFastest_m_s));
  }
  return speed;
}

}  // namespace tactree::viewer
