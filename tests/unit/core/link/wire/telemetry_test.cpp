// The telemetry message: the encoder and the decoder against fixed bytes, and against each other.

#include "tactree/core/link/wire/telemetry.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

namespace tactree::test {
namespace {

namespace wire = core::wire;

core::Status some_status() {
  core::Status s;
  s.tick = 1;
  s.state = core::State::kActive;
  s.faults = 0x20;
  s.limits = 0x3;
  s.overruns = 7;
  s.load = 0.5F;
  s.probe = {1.0F, 2.0F, 3.0F};
  s.velocity = {4.0F, 5.0F, 6.0F};
  s.force = {7.0F, 8.0F, 9.0F};
  s.rendering.in_contact = true;
  s.rendering.proxy = {10.0F, 11.0F, 12.0F};
  s.rendering.normal = {0.0F, 0.0F, 1.0F};
  s.rendering.penetration_m = 0.25F;
  s.rendering.body = 1;
  s.rendering.strength = 0.75F;
  s.rendering.force = {13.0F, 14.0F, 15.0F};
  s.reactions[0] = {1, {16.0F, 17.0F, 18.0F}, {19.0F, 20.0F, 21.0F}};
  s.gravity_force = {22.0F, 23.0F, 24.0F};
  s.added_force = {25.0F, 26.0F, 27.0F};
  s.motor_force = {28.0F, 29.0F, 30.0F};
  return s;
}

std::vector<std::byte> encode(const core::Status& status, std::uint32_t fields) {
  std::array<std::byte, wire::kMaxTelemetry> bytes{};
  const std::size_t size =
      wire::encode_telemetry(wire::to_telemetry({status.tick, 2000, fields, 5}, status), bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// 4-byte words of a message; floats by their bits.
std::vector<std::uint32_t> words_of(const std::vector<std::byte>& bytes) {
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

std::uint32_t bits(float value) {
  std::uint32_t word = 0;
  std::memcpy(&word, &value, sizeof word);
  return word;
}

TEST(Telemetry, EncodesEachFieldAsDocumented) {
  const core::Status s = some_status();
  const auto three = [](float a, float b, float c) {
    return std::vector<std::uint32_t>{bits(a), bits(b), bits(c)};
  };
  const std::vector<std::uint32_t> nobody = {core::kNoBody, 0, 0, 0, 0, 0, 0};
  std::vector<std::uint32_t> reactions = {1,           bits(16.0F), bits(17.0F), bits(18.0F),
                                          bits(19.0F), bits(20.0F), bits(21.0F)};
  reactions.insert(reactions.end(), nobody.begin(), nobody.end());
  const std::vector<std::vector<std::uint32_t>> expected = {
      {static_cast<std::uint32_t>(core::State::kActive), 0x20, 0x3},
      three(1.0F, 2.0F, 3.0F),
      three(4.0F, 5.0F, 6.0F),
      three(7.0F, 8.0F, 9.0F),
      three(10.0F, 11.0F, 12.0F),
      three(0.0F, 0.0F, 1.0F),
      {bits(0.25F), 1, bits(0.75F)},
      three(13.0F, 14.0F, 15.0F),
      {7, bits(0.5F)},
      reactions,
      {bits(22.0F), bits(23.0F), bits(24.0F), bits(25.0F), bits(26.0F), bits(27.0F), bits(28.0F),
       bits(29.0F), bits(30.0F)}};
  ASSERT_EQ(expected.size(), wire::kTelemetryFields);
  std::vector<std::uint32_t> all = {1, 2000, wire::kAllTelemetry, 5};
  for (std::uint32_t i = 0; i < wire::kTelemetryFields; ++i) {
    std::vector<std::uint32_t> one = {1, 2000, 1U << i, 5};
    one.insert(one.end(), expected[i].begin(), expected[i].end());
    EXPECT_EQ(words_of(encode(s, 1U << i)), one) << "field " << i;
    all.insert(all.end(), expected[i].begin(), expected[i].end());
  }
  EXPECT_EQ(words_of(encode(s, wire::kAllTelemetry)), all);
}

TEST(Telemetry, SendsZeroPenetrationWithoutContact) {
  core::Status s = some_status();
  s.rendering.in_contact = false;
  const auto contact = static_cast<std::uint32_t>(wire::TelemetryField::kContact);
  EXPECT_EQ(words_of(encode(s, contact)),
            (std::vector<std::uint32_t>{1, 2000, contact, 5, 0, core::kNoBody, 0}));
}

TEST(Telemetry, DecodesEveryFieldSelection) {
  const core::Status s = some_status();
  for (std::uint32_t fields = 0; fields <= wire::kAllTelemetry; ++fields) {
    const std::vector<std::byte> message = encode(s, fields);
    wire::Telemetry decoded;
    ASSERT_TRUE(wire::decode_telemetry(message, decoded));
    std::array<std::byte, wire::kMaxTelemetry> again{};
    const std::size_t size = wire::encode_telemetry(decoded, again);
    ASSERT_EQ(size, message.size());
    ASSERT_EQ(std::memcmp(again.data(), message.data(), size), 0) << "fields " << fields;
    const bool has_state = (fields & 1U) != 0U;
    EXPECT_EQ(decoded.limits, has_state ? 0x3U : 0U);
    EXPECT_EQ(decoded.body, (fields & (1U << 6U)) != 0U ? 1U : core::kNoBody);
  }
}

TEST(Telemetry, RefusesEveryTruncatedMessage) {
  const core::Status s = some_status();
  for (std::uint32_t fields : {0U, 1U, 0x150U, wire::kAllTelemetry}) {
    const std::vector<std::byte> message = encode(s, fields);
    for (std::size_t size = 0; size < message.size(); ++size) {
      wire::Telemetry decoded;
      const std::vector<std::byte> cut(message.begin(),
                                       message.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(wire::decode_telemetry(cut, decoded)) << fields << " at " << size;
    }
  }
}

TEST(Telemetry, IgnoresBytesAfterFields) {
  std::vector<std::byte> message = encode(some_status(), 2U);
  message.push_back(std::byte{0x55});
  wire::Telemetry decoded;
  EXPECT_TRUE(wire::decode_telemetry(message, decoded));
  EXPECT_EQ(decoded.probe_m[2], 3.0F);
}

}  // namespace
}  // namespace tactree::test
