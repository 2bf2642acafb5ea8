// Device files: mistakes with their places, defaults, and ranges.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "device_fields.hpp"
#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

using nlohmann::ordered_json;

class DeviceReaderTest : public test::FolderTest {
 protected:
  DeviceReading read(const std::string& text) const {
    return read_device(write("own.json", text).string());
  }

  /// The mistakes as "line:column field".
  static std::vector<std::string> places(const DeviceReading& reading) {
    std::vector<std::string> places;
    for (const DeviceMistake& m : reading.mistakes) {
      places.push_back(std::to_string(m.line) + ":" + std::to_string(m.column) + " " + m.field);
    }
    return places;
  }

  static ordered_json paddle() { return ordered_json::parse(device_json(load_device("hapkit"))); }
};

using Places = std::vector<std::string>;

TEST_F(DeviceReaderTest, NamesAllMistakesWithPositions) {
  const DeviceReading reading = read(
      "{\n"
      "  \"name\": \"own\", \"kind\": \"paddle\",\n"
      "  \"homing\": \"hardstop\",\n"
      "  \"padle_m\": 0.07,\n"
      "  \"counts_per_revolution\": [2048, 1, 1],\n"
      "  \"ratio\": [0, 1, \"1\"],\n"
      "  \"home_position\": [2, 0, 0], \"joint_min\": [-1, -1, -1],\n"
      "  \"joint_max\": [1, 1, 1],\n"
      "  \"joint_margin\": [1.5, 0, 0],\n"
      "  \"base_m\": 0.1,\n"
      "  \"torque_constant_Nm_per_ampere\": [0.02, 0.02],\n"
      "  \"effort_max\": [0.4, 0.4, 0.4],\n"
      "  \"force_max_N\": 5000,\n"
      "  \"inertia\": [2e-4, 1, 1]\n"
      "}\n");
  EXPECT_EQ(places(reading),
            (Places{"1:1 origin_m", "3:13 homing", "4:3 padle_m", "6:13 ratio[0]", "6:19 ratio[2]",
                    "7:21 home_position[0]", "9:20 joint_margin[0]", "10:3 base_m",
                    "11:36 torque_constant_Nm_per_ampere", "13:18 force_max_N"}));
  EXPECT_EQ(reading.mistakes[1].remedy,
            "did you mean 'hard-stop'? one of: absolute, given-pose, index, hard-stop");
  EXPECT_EQ(reading.mistakes[2].remedy, "did you mean 'paddle_m'?");
  EXPECT_EQ(reading.mistakes[9].cause, "5000 is out of range");
  EXPECT_EQ(reading.mistakes[9].remedy, "give 0.01 .. 1000");
  EXPECT_EQ(reading.mistakes[7].cause, "does not belong to a device of this kind");
}

TEST_F(DeviceReaderTest, RefusesWithOneLinePerMistake) {
  ordered_json json = paddle();
  json["tip_mass_kg"] = -1;
  json["ratio"][0] = 0.0;
  const std::string file = write("own.json", json.dump()).string();
  const std::string message = test::message_of<UserError>([&] { (void)load_device(file); });
  EXPECT_EQ(message.find(file + ":1:"), 0U) << message;
  EXPECT_NE(message.find(": ratio[0]: 0 is too close to 0 (give at least 0.001, or at most -0.001 "
                         "for the opposite direction)\n" +
                         file + ":1:"),
            std::string::npos)
      << message;
  EXPECT_NE(message.find(": tip_mass_kg: -1 is out of range (give 0 .. 100)"), std::string::npos)
      << message;
}

TEST_F(DeviceReaderTest, FindsSyntaxErrors) {
  const DeviceReading comma = read("{\n  \"name\": \"\xC3\xA4\",\n}");
  EXPECT_EQ(places(comma), Places{"3:1 "});
  EXPECT_EQ(comma.mistakes[0].cause.find("is not JSON: "), 0U) << comma.mistakes[0].cause;
  EXPECT_EQ(places(read("")), Places{"1:1 "});
  EXPECT_EQ(places(read("[1]")), Places{"1:1 "});
  const DeviceReading overflow = read("{\"name\": 1e999}");
  ASSERT_EQ(overflow.mistakes.size(), 1U);
  EXPECT_NE(overflow.mistakes[0].cause.find("1e999"), std::string::npos);
}

TEST_F(DeviceReaderTest, CountsColumnsInCharacters) {
  std::string text = paddle().dump();
  text.insert(1, "\"about\": \"\xC3\xA4\xC3\xB6\", \"oops\": 1,");
  const DeviceReading reading = read(text);
  EXPECT_EQ(places(reading), (Places{"1:17 oops", "1:43 about"}));
  EXPECT_EQ(reading.mistakes[1].cause, "is stated in line 1, too");
}

TEST_F(DeviceReaderTest, IgnoresBomAndNestedValues) {
  ordered_json json = paddle();
  json["ratio"] = {13.0, 1.0, 1.0};
  json["extra"] = {{"ratio", {{"ratio", 1}}}, {"list", {1, {2, {3}}}}};
  EXPECT_EQ(places(read("\xEF\xBB\xBF" + json.dump(1))).size(), 1U);
  json.erase("extra");
  EXPECT_TRUE(read("\xEF\xBB\xBF" + json.dump(1)).mistakes.empty());
}

TEST_F(DeviceReaderTest, ChecksCommonKeysOfUnknownKind) {
  ordered_json json = paddle();
  json["kind"] = "padle";
  json["effort_max"] = 3;
  json["counts"] = 1;
  const DeviceReading reading = read(json.dump(1));
  EXPECT_EQ(places(reading), (Places{"4:10 kind", "59:16 effort_max", "76:2 counts"}));
  EXPECT_EQ(reading.mistakes[0].remedy.find("did you mean 'paddle'?"), 0U);
}

TEST_F(DeviceReaderTest, LimitsNumberOfMistakes) {
  ordered_json json = paddle();
  for (int i = 0; i < 150; ++i) {
    json["zzzzzzzzzzzzzz" + std::to_string(i)] = i;
  }
  const DeviceReading reading = read(json.dump(1));
  ASSERT_EQ(reading.mistakes.size(), 101U);
  EXPECT_EQ(reading.mistakes.back().cause, "50 more mistakes from here on");
}

TEST_F(DeviceReaderTest, ReportsDefaultsInUse) {
  ordered_json json = paddle();
  for (const char* key : {"name", "about", "homing", "link_mass_kg", "tip_mass_kg", "viscous"}) {
    json.erase(key);
  }
  const DeviceReading reading = read(json.dump());
  EXPECT_TRUE(reading.mistakes.empty());
  EXPECT_EQ(reading.device.name, "own");
  EXPECT_EQ(reading.device.preset.model.homing, core::HomingMethod::kGivenPose);
  EXPECT_EQ(defaults_text(reading.device),
            "homing = given-pose, link_mass_kg = [0, 0, 0], tip_mass_kg = 0, viscous = [0, 0, 0]");
  EXPECT_EQ(reading.device.preset.dynamics.viscous[1], 0.0F);
  // A written file states every value.
  EXPECT_EQ(defaults_text(read(device_json(reading.device)).device), "");
}

TEST_F(DeviceReaderTest, ReadsWrittenPresetsUnchanged) {
  for (const std::string& name : device_names()) {
    const std::string written = device_json(load_device(name));
    const DeviceReading reading = read(written);
    EXPECT_EQ(places(reading), Places{}) << name;
    EXPECT_EQ(device_json(reading.device), written);
    EXPECT_TRUE(reading.device.defaults.empty()) << name;
  }
}

/// The relations between the values of an axis have tests above.
bool has_relations(const std::string& key) {
  return key == "home_position" || key.find("joint_") == 0;
}

TEST(DeviceFields, RangesAreThoseOfController) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const core::DevicePreset& preset : core::kDevicePresets) {
    for (const DeviceField& field : device_fields()) {
      if (!field.belongs_to(preset.model.kind) || has_relations(field.key) ||
          std::string(field.member).find("model.") != 0) {
        continue;
      }
      core::DevicePreset device = preset;
      float& value = *field.values(device)[0];
      const auto accepts = [&](float v) {
        value = v;
        return core::is_valid(device.model);
      };
      EXPECT_TRUE(accepts(field.low) && accepts(field.high)) << preset.name << " " << field.key;
      EXPECT_FALSE(accepts(std::nextafter(field.low, -kInfinity))) << field.key;
      EXPECT_FALSE(accepts(std::nextafter(field.high, kInfinity))) << field.key;
      if (field.magnitude_min > 0.0F) {
        EXPECT_TRUE(accepts(field.magnitude_min) && accepts(-field.magnitude_min)) << field.key;
        EXPECT_FALSE(accepts(std::nextafter(field.magnitude_min, 0.0F))) << field.key;
      }
    }
  }
}

TEST(DeviceFields, DefaultsAreInRange) {
  for (const DeviceField& field : device_fields()) {
    if (field.fallback) {
      EXPECT_TRUE(*field.fallback >= field.low && *field.fallback <= field.high) << field.key;
      EXPECT_NE(field.consequence, nullptr) << field.key;
    }
  }
}

}  // namespace
}  // namespace tactree::support
