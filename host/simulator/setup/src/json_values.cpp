#include "json_values.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tactree/support/user_error.hpp"

namespace tactree::setup {

using nlohmann::json;

json parse_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    support::refuse(file.string(), "cannot be read", "give a JSON file");
  }
  try {
    return json::parse(in);
  } catch (const json::exception& error) {
    support::refuse(file.string(), fmt::format("is not JSON: {}", error.what()),
                    "correct the file there");
  }
}

void require_keys(const json& object, const std::string& place,
                  std::initializer_list<const char*> known) {
  if (!object.is_object()) {
    support::refuse(place, "is not an object", "write it in braces");
  }
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      std::string keys;
      for (const char* name : known) {
        keys += fmt::format("{}{}", keys.empty() ? "" : ", ", name);
      }
      support::refuse(place + "." + key, "is an unknown key", "remove it, or use one of " + keys);
    }
  }
}

double number(const json& value, const std::string& place) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    support::refuse(place, "is not a number", "write a number, without quotes");
  }
  return value.get<double>();
}

std::vector<double> numbers(const json& value, const std::string& place, std::size_t count) {
  if (!value.is_array() || value.size() != count) {
    support::refuse(place, fmt::format("is not a list of {} numbers", count),
                    "write that many numbers");
  }
  std::vector<double> list;
  for (std::size_t i = 0; i < count; ++i) {
    list.push_back(number(value[i], fmt::format("{}[{}]", place, i)));
  }
  return list;
}

Eigen::Vector3d vector(const json& object, const char* key, const std::string& place) {
  if (!object.contains(key)) {
    return Eigen::Vector3d::Zero();
  }
  const std::vector<double> v = numbers(object[key], place + "." + key, 3);
  return {v[0], v[1], v[2]};
}

Eigen::Isometry3d pose(const json& value, const std::string& place) {
  simulation::PoseRows rows{};
  const std::vector<double> list = numbers(value, place, rows.size());
  std::copy(list.begin(), list.end(), rows.begin());
  if (const std::optional<simulation::PoseProblem> problem = simulation::problem_of(rows)) {
    support::refuse(place, problem->cause, problem->remedy);
  }
  return simulation::pose_of(rows);
}

}  // namespace tactree::setup
