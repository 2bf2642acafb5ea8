#include "tactree/support/json_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

constexpr std::uintmax_t kMaxBytes = 1U << 20U;

}  // namespace

JsonReader::JsonReader(std::string file, const Json& json, std::string page, std::string place)
    : file_(std::move(file)), json_(json), page_(std::move(page)), place_(std::move(place)) {
  if (!json.is_object()) {
    throw UserError(fmt::format("{}: {} is not an object (write it in braces)", file_,
                                place_.empty() ? "it" : place_));
  }
}

std::string JsonReader::path(const std::string& key) const {
  return place_.empty() ? key : place_ + "." + key;
}

void JsonReader::refuse(const std::string& key, const std::string& cause,
                        const std::string& remedy) const {
  throw UserError(fmt::format("{}: {}: {} ({})", file_, path(key), cause, remedy));
}

const JsonReader::Json& JsonReader::get(const char* key) {
  known_.emplace_back(key);
  const auto found = json_.find(key);
  if (found == json_.end()) {
    refuse(key, "is missing", "see " + page_);
  }
  return *found;
}

double JsonReader::number(const std::string& key, const Json& value, double low,
                          double high) const {
  if (!value.is_number()) {
    refuse(key, "is not a number", fmt::format("give {:.6g} .. {:.6g}", low, high));
  }
  const double figure = value.get<double>();
  // A limit that was written as a float may have been rounded outwards by half a unit in the last
  // place.
  if (!(figure >= low - 1e-7 * std::abs(low) && figure <= high + 1e-7 * std::abs(high))) {
    refuse(key, fmt::format("{:.6g} is out of range", figure),
           fmt::format("give {:.6g} .. {:.6g}", low, high));
  }
  return figure;
}

void JsonReader::one(const char* key, float& value, double low, double high) {
  value = static_cast<float>(number(key, get(key), low, high));
}

void JsonReader::each(const char* key, float (&values)[core::kAxes], double low, double high) {
  const Json& array = get(key);
  if (!array.is_array() || array.size() != core::kAxes) {
    refuse(key, "is not a list of three numbers", "one number for each axis, in [brackets]");
  }
  for (std::size_t i = 0; i < core::kAxes; ++i) {
    values[i] = static_cast<float>(number(fmt::format("{}[{}]", key, i), array[i], low, high));
  }
}

std::uint32_t JsonReader::whole(const char* key, std::uint32_t low, std::uint32_t high) {
  const Json& value = get(key);
  const double figure = number(key, value, low, high);
  if (figure != std::floor(figure)) {
    refuse(key, fmt::format("{:.6g} is not an integer", figure), "round it");
  }
  return static_cast<std::uint32_t>(figure);
}

bool JsonReader::flag(const char* key) {
  const Json& value = get(key);
  if (!value.is_boolean()) {
    refuse(key, "is neither true nor false", "write one of them, without quotes");
  }
  return value.get<bool>();
}

std::string JsonReader::text(const char* key) {
  const Json& value = get(key);
  if (!value.is_string()) {
    refuse(key, "is not a string", "write it in quotes");
  }
  return value.get<std::string>();
}

JsonReader JsonReader::object(const char* key) { return {file_, get(key), page_, path(key)}; }

std::vector<JsonReader> JsonReader::objects(const char* key, std::size_t low, std::size_t high) {
  const Json& array = get(key);
  if (!array.is_array() || array.size() < low || array.size() > high) {
    refuse(key, "is not a list of the required length",
           low == high ? fmt::format("give {}", low) : fmt::format("give {} to {}", low, high));
  }
  std::vector<JsonReader> readers;
  for (std::size_t i = 0; i < array.size(); ++i) {
    readers.emplace_back(file_, array[i], page_, fmt::format("{}[{}]", path(key), i));
  }
  return readers;
}

void JsonReader::finish() const {
  for (const auto& [key, value] : json_.items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      refuse(key, "is unknown", page_ + " lists the keys");
    }
  }
}

JsonReader::Json read_json(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) {
    throw UserError(fmt::format("{}: cannot be read: {} (check the path and its permissions)",
                                file.string(), error.message()));
  }
  if (bytes > kMaxBytes) {
    throw UserError(fmt::format("{}: is too large (at most 1 MiB)", file.string()));
  }
  std::ifstream stream(file);
  try {
    return JsonReader::Json::parse(stream);
  } catch (const nlohmann::json::parse_error& cause) {
    throw UserError(
        fmt::format("{}: byte {}: not valid JSON (correct it there)", file.string(), cause.byte));
  }
}

}  // namespace tactree::support
