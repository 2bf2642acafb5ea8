// Only a complete, undamaged recording is read; the message states place, cause and hint.

#include "tactree/simulation/recording.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "message_of.hpp"
#include "recorded_session.hpp"

namespace tactree::test {
namespace {

using simulation::Recording;
using simulation::RecordingError;

const std::vector<std::byte>& sound() {
  static const std::vector<std::byte> bytes =
      record_session(std::make_unique<simulation::HostTarget>()).bytes;
  return bytes;
}

std::string refusal(std::vector<std::byte> bytes) {
  return message_of<RecordingError>([&] { const Recording recording(bytes); });
}

void seal(std::vector<std::byte>& bytes) {
  const std::uint32_t crc = core::crc32(std::span(bytes).first(bytes.size() - 4));
  std::memcpy(&bytes[bytes.size() - 4], &crc, sizeof crc);
}

TEST(Recording, ContainsSessionAndModel) {
  const Recording recording(sound());
  EXPECT_EQ(recording.ticks(), 1000U + simulation::Simulation::arming_ticks({}));
  ASSERT_EQ(recording.models().size(), 1U);
  EXPECT_EQ(recording.models()[0], simulation::digest_of(touched_plane().bytes()));
  EXPECT_LT(sound().size(), 25U * recording.ticks());
}

TEST(Recording, KeepsEveryConfigurationField) {
  // All bytes differ: detects omitted and exchanged fields.
  core::Configuration configuration;
  simulation::SessionWriter writer;
  float value = 1.0F;
  for (float* field :
       {&configuration.rate_hz, &configuration.contact.stiffness_N_m, &configuration.limits.ramp_s,
        &configuration.device.delta.leg_rad[2], &configuration.device.five_bar.base_m,
        &configuration.device.torque_constant_Nm_per_ampere[2],
        &configuration.supervision.enable_timeout_s, &configuration.motors.thermal_time_s,
        &configuration.model_origin_m.y}) {
    *field = value;
    value += 1.0F;
  }
  configuration.device.homing = core::HomingMethod::kIndex;
  configuration.supervision.dead_man_required = false;
  writer.configured(configuration);
  const std::vector<std::byte> bytes = writer.finish();
  Recording recording(bytes);
  simulation::RecordedEvent event;
  ASSERT_TRUE(recording.next(event));
  const auto& read = std::get<core::Configuration>(event);
  simulation::SessionWriter again;
  again.configured(read);
  EXPECT_EQ(again.finish(), bytes);
  EXPECT_EQ(read.supervision.enable_timeout_s, configuration.supervision.enable_timeout_s);
  EXPECT_EQ(read.device.homing, core::HomingMethod::kIndex);
  EXPECT_FALSE(read.supervision.dead_man_required);
}

TEST(Recording, RefusesForeignFile) {
  EXPECT_EQ(refusal({}),
            "byte 0: not a recording of a session (give a file that simulate --record wrote)");
  const auto text = std::as_bytes(std::span("t_s,x,y,z: this is a CSV file, and not a recording"));
  EXPECT_EQ(refusal({text.begin(), text.end()}),
            "byte 0: not a recording of a session (give a file that simulate --record wrote)");
}

TEST(Recording, RefusesAnotherVersion) {
  std::vector<std::byte> bytes = sound();
  bytes[8] = std::byte{1};
  EXPECT_EQ(refusal(bytes),
            "byte 8: version 1 of the format; this program reads version 4 (replay it with the "
            "version of tactree that recorded it)");
}

TEST(Recording, RefusesEveryTruncation) {
  for (std::size_t size = 0; size < sound().size(); size += size < 200 ? 1 : 97) {
    const std::vector<std::byte> bytes(sound().begin(),
                                       sound().begin() + static_cast<std::ptrdiff_t>(size));
    const std::string text = refusal(bytes);
    EXPECT_NE(text.find(size < 8 ? "not a recording" : "truncated"), std::string::npos) << text;
  }
}

TEST(Recording, RefusesEveryDamagedByte) {
  for (std::size_t i = 0; i < sound().size(); i += i < 200 ? 1 : 101) {
    std::vector<std::byte> bytes = sound();
    bytes[i] ^= std::byte{0x10};
    EXPECT_NE(refusal(bytes), "") << i;
  }
}

// Forged bytes with a valid checksum: refused or replayed, without reads outside the file.
TEST(Recording, ReadsNothingOutsideForgedFile) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes = sound();
    for (int n = 0; n < 3; ++n) {
      const std::size_t at = 20 + random() % (i % 2 == 0 ? 600U : bytes.size() - 24U);
      bytes[at] = static_cast<std::byte>(random());
    }
    seal(bytes);
    (void)refusal(bytes);
  }
}

}  // namespace
}  // namespace tactree::test
