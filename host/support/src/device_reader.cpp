// Reads device files and finds their mistakes.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "device_fields.hpp"
#include "json_positions.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/nearest_name.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

constexpr std::uintmax_t kMaxDeviceBytes = 1U << 20U;
constexpr std::size_t kMaxMistakes = 100;
constexpr std::size_t kKeyCharacters = 60;  // of a key in a message

std::string range_text(const DeviceField& field) {
  return fmt::format("{:.6g} .. {:.6g}", field.low, field.high);
}

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string quoted(const std::string& name) {
  return name.size() > kKeyCharacters ? "'" + name.substr(0, kKeyCharacters) + "...'"
                                      : "'" + name + "'";
}

class DeviceReader {
 public:
  /// Precondition: `text` is the JSON object `json`.
  DeviceReader(const std::string& text, const nlohmann::json& json, std::string file_name)
      : text_(text), json_(json), positions_(text), file_name_(std::move(file_name)) {}

  DeviceReading run() {
    for (const JsonPositions::Repetition& again : positions_.repetitions()) {
      const std::size_t line = position_of(text_, again.first).line;
      add(again.offset, again.key, fmt::format("is stated in line {}, too", line), "keep one");
    }
    read_texts();
    check_keys();
    for (const DeviceField& field : device_fields()) {
      if (kind_ ? field.belongs_to(*kind_) : field.belongs_to_all()) {
        read_field(field);
      }
    }
    if (kind_) {
      check_axes(core::axes_of(*kind_));
    }
    if (found_.empty() && !core::is_valid(device_.preset.model)) {
      add(positions_.value("kind"), "kind", "the values do not describe a device",
          "compare them with those of `tactree simulate --dump-device`");
    }
    return {std::move(device_), mistakes()};
  }

 private:
  struct Found {
    std::size_t offset;
    DeviceMistake mistake;
  };

  void add(std::size_t offset, const std::string& field, std::string cause, std::string remedy) {
    found_.push_back({offset, {1, 1, field, std::move(cause), std::move(remedy)}});
  }
  void add_value(const std::string& path, std::string cause, std::string remedy) {
    add(positions_.value(path), path, std::move(cause), std::move(remedy));
  }

  std::vector<DeviceMistake> mistakes() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Found& a, const Found& b) { return a.offset < b.offset; });
    std::vector<DeviceMistake> result;
    for (Found& found : found_) {
      const TextPosition position = position_of(text_, found.offset);
      found.mistake.line = position.line;
      found.mistake.column = position.column;
      if (result.size() == kMaxMistakes) {
        found.mistake.field.clear();
        found.mistake.cause =
            fmt::format("{} more mistakes from here on", found_.size() - kMaxMistakes);
        found.mistake.remedy = "correct the others first";
      }
      result.push_back(std::move(found.mistake));
      if (result.size() > kMaxMistakes) {
        break;
      }
    }
    return result;
  }

  void read_texts() {
    std::map<std::string, std::string> values;
    for (const DeviceText& text : device_texts()) {
      if (const std::optional<std::string> value = read_text(text)) {
        values[text.key] = *value;
      }
    }
    device_.name = values.try_emplace("name", file_name_).first->second;
    device_.about = values["about"];
    kind_ = index_of<core::DeviceKind>(kKindNames, values["kind"]);
    device_.preset.model.kind = kind_.value_or(core::DeviceKind::kCartesian);
    device_.preset.model.homing = index_of<core::HomingMethod>(kHomingNames, values["homing"])
                                      .value_or(core::HomingMethod::kGivenPose);
  }

  template <class Enum, std::size_t N>
  static std::optional<Enum> index_of(const char* const (&names)[N], const std::string& name) {
    const auto found = std::find(std::begin(names), std::end(names), name);
    return found == std::end(names)
               ? std::nullopt
               : std::optional(static_cast<Enum>(std::distance(std::begin(names), found)));
  }

  std::optional<std::string> read_text(const DeviceText& text) {
    const std::vector<std::string> choices(text.choices.begin(), text.choices.end());
    const auto value = json_.find(text.key);
    if (value == json_.end()) {
      if (text.required) {
        add(positions_.key(text.key), text.key, "is missing",
            fmt::format("add it: {}, one of: {}", text.about, listed(choices)));
      } else if (text.consequence != nullptr) {
        device_.defaults.push_back({text.key, text.fallback, text.consequence});
      }
      return text.fallback == nullptr ? std::nullopt : std::optional<std::string>(text.fallback);
    }
    if (!value->is_string()) {
      add_value(text.key, "is not a string", "write it in quotes");
      return std::nullopt;
    }
    const auto name = value->get<std::string>();
    if (!choices.empty() && std::find(choices.begin(), choices.end(), name) == choices.end()) {
      const std::string nearest = nearest_name(name, choices);
      add_value(text.key, quoted(name) + " is unknown",
                nearest.empty()
                    ? "one of: " + listed(choices)
                    : fmt::format("did you mean '{}'? one of: {}", nearest, listed(choices)));
      return std::nullopt;
    }
    return name;
  }

  void check_keys() {
    std::vector<std::string> known;
    std::set<std::string> others;  // keys of other kinds
    for (const DeviceText& text : device_texts()) {
      known.emplace_back(text.key);
    }
    for (const DeviceField& field : device_fields()) {
      if (!kind_ || field.belongs_to(*kind_)) {
        known.emplace_back(field.key);
      } else {
        others.insert(field.key);
      }
    }
    for (const auto& [key, value] : json_.items()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) {
        continue;
      }
      if (others.count(key) != 0) {
        add(positions_.key(key), key, "does not belong to a device of this kind",
            fmt::format("leave it out, or correct the kind, '{}'",
                        kKindNames[static_cast<std::size_t>(*kind_)]));
        continue;
      }
      add_unknown(key, known);
    }
  }

  void add_unknown(const std::string& key, const std::vector<std::string>& known) {
    const std::string nearest = found_.size() < kMaxMistakes ? nearest_name(key, known) : "";
    if (!nearest.empty()) {
      meant_.insert(nearest);
    }
    add(positions_.key(key), key.substr(0, kKeyCharacters), "is unknown",
        nearest.empty() ? "leave it out; `tactree device schema` lists the keys"
                        : fmt::format("did you mean '{}'?", nearest));
  }

  void read_field(const DeviceField& field) {
    const DeviceValues values = field.values(device_.preset);
    const auto found = json_.find(field.key);
    if (found == json_.end()) {
      use_default(field, values);
      return;
    }
    if (!field.per_axis()) {
      if (const std::optional<float> value = number(field.key, *found, field, 0)) {
        *values[0] = *value;
        read_.insert(field.key);
      }
      return;
    }
    if (!found->is_array() || found->size() != core::kAxes) {
      add_value(field.key, "is not a list of three numbers",
                fmt::format("give one of {} for each axis, in [brackets]; {} for an unused axis",
                            range_text(field), field.low > 0.0F ? 1 : 0));
      return;
    }
    bool good = true;
    for (std::size_t i = 0; i < core::kAxes; ++i) {
      const std::string path = fmt::format("{}[{}]", field.key, i);
      const std::optional<float> value = number(path, (*found)[i], field, i);
      good = good && value.has_value();
      *values[i] = value.value_or(0.0F);
    }
    if (good) {
      read_.insert(field.key);
    }
  }

  void use_default(const DeviceField& field, const DeviceValues& values) {
    if (field.fallback) {
      for (std::size_t i = 0; i < field.count(); ++i) {
        *values[i] = *field.fallback;
      }
      const std::string value = fmt::format("{}", *field.fallback);
      device_.defaults.push_back({field.key,
                                  field.per_axis() ? fmt::format("[{0}, {0}, {0}]", value) : value,
                                  field.consequence});
    } else if (meant_.count(field.key) == 0) {  // else the wrong key is a mistake already
      add(positions_.key(field.key), field.key, "is missing",
          fmt::format("add it: {}; {}{}", field.about,
                      field.per_axis() ? "a list of three numbers, " : "", range_text(field)));
    }
  }

  std::optional<float> number(const std::string& path, const nlohmann::json& value,
                              const DeviceField& field, std::size_t axis) {
    if (!value.is_number()) {
      add_value(path, "is not a number", fmt::format("give {}, without quotes", range_text(field)));
      return std::nullopt;
    }
    constexpr auto kMaxFloat = static_cast<double>(std::numeric_limits<float>::max());
    const auto figure = value.get<double>();
    // As floats, in which the file may have been computed, and which the controller compares.
    const auto result = static_cast<float>(std::clamp(figure, -kMaxFloat, kMaxFloat));
    if (!(result >= field.low && result <= field.high)) {
      add_value(path, fmt::format("{:.6g} is out of range", figure), "give " + range_text(field));
      return std::nullopt;
    }
    if (kind_ && axis < core::axes_of(*kind_) && std::abs(result) < field.magnitude_min) {
      add_value(path, fmt::format("{:.6g} is too close to 0", figure),
                fmt::format("give at least {0:.6g}, or at most -{0:.6g} for the opposite direction",
                            field.magnitude_min));
      return std::nullopt;
    }
    return result;
  }

  /// Relations between the values of an axis.
  void check_axes(std::size_t axes) {
    const core::DeviceModel& model = device_.preset.model;
    if (read_.count("joint_min") == 0 || read_.count("joint_max") == 0) {
      return;
    }
    for (std::size_t i = 0; i < axes; ++i) {
      const float low = model.joint_min[i];
      const float high = model.joint_max[i];
      const std::string axis = fmt::format("[{}]", i);
      if (!(low < high)) {
        add_value("joint_min" + axis, fmt::format("{} is not below joint_max, {}", low, high),
                  "exchange them");
        continue;
      }
      const float home = model.home_position[i];
      if (read_.count("home_position") != 0 && !(home >= low && home <= high)) {
        add_value("home_position" + axis, fmt::format("{} is outside the range of the joint", home),
                  fmt::format("give {} .. {}, joint_min to joint_max", low, high));
      }
      const float margin = model.joint_margin[i];
      if (read_.count("joint_margin") != 0 && !(margin <= 0.5F * (high - low))) {
        add_value("joint_margin" + axis,
                  fmt::format("{} is more than half of the range of the joint", margin),
                  fmt::format("give 0 .. {}", 0.5F * (high - low)));
      }
    }
  }

  const std::string& text_;
  const nlohmann::json& json_;
  JsonPositions positions_;
  std::string file_name_;
  Device device_;
  std::optional<core::DeviceKind> kind_;
  std::vector<Found> found_;
  std::set<std::string> read_;   // keys of valid values
  std::set<std::string> meant_;  // keys that unknown ones are similar to
};

std::string read_bytes(const std::string& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) {
    throw UserError(
        fmt::format("'{}' is neither a device nor a readable file (devices: {}; or write a file "
                    "with `tactree simulate --dump-device`)",
                    file, listed(device_names())));
  }
  if (bytes > kMaxDeviceBytes) {
    throw UserError(fmt::format("{}: is too large for a device (at most 1 MiB)", file));
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw UserError(fmt::format("{}: cannot be read (check its permissions)", file));
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

DeviceReading refused(const std::string& text, std::size_t offset, std::string cause,
                      std::string remedy) {
  const TextPosition at = position_of(text, offset);
  return {{}, {{at.line, at.column, "", std::move(cause), std::move(remedy)}}};
}

}  // namespace

DeviceReading read_device(const std::string& file) {
  const std::string text = read_bytes(file);
  if (const std::optional<JsonError> error = find_json_error(text)) {
    return refused(text, error->offset, "is not JSON: " + error->cause,
                   "correct it there, or the comma, quote or bracket before");
  }
  const nlohmann::json json = nlohmann::json::parse(text);
  if (!json.is_object()) {
    return refused(text, 0, "is not a JSON object",
                   "begin with a file of `tactree simulate --dump-device`");
  }
  return DeviceReader(text, json, std::filesystem::path(file).stem().string()).run();
}

std::string mistake_text(const std::string& file, const DeviceMistake& mistake) {
  return fmt::format("{}:{}:{}: {}{}{} ({})", file, mistake.line, mistake.column, mistake.field,
                     mistake.field.empty() ? "" : ": ", mistake.cause, mistake.remedy);
}

std::string defaults_text(const Device& device) {
  std::vector<std::string> texts;
  for (const DeviceDefault& used : device.defaults) {
    texts.push_back(fmt::format("{} = {}", used.field, used.value));
  }
  return listed(texts);
}

}  // namespace tactree::support
