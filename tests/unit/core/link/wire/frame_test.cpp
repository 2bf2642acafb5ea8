#include "tactree/core/link/wire/frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "folders.hpp"
#include "tactree/core/link/wire/messages.hpp"

namespace tactree::core::wire {
namespace {

using Bytes = std::vector<std::byte>;

Bytes encoded(const FrameHeader& header, const Bytes& payload) {
  Bytes out(kMaxEncodedFrame);
  out.resize(encode_frame(header, payload, out));
  return out;
}

struct Found {
  FrameHeader header;
  Bytes payload;
};

struct Decoded {
  std::vector<Found> frames;
  int damaged = 0;
};

Decoded decoded(const Bytes& stream) {
  FrameDecoder decoder;
  Decoded result;
  for (const std::byte byte : stream) {
    const auto found = decoder.push(byte);
    if (found == FrameDecoder::Result::kFrame) {
      const auto payload = decoder.payload();
      result.frames.push_back({decoder.header(), Bytes(payload.begin(), payload.end())});
    }
    result.damaged += found == FrameDecoder::Result::kDamaged ? 1 : 0;
  }
  return result;
}

Bytes random_bytes(std::mt19937& random, std::size_t size, unsigned zeros_in_4) {
  Bytes bytes(size);
  for (std::byte& byte : bytes) {
    byte = random() % 4U < zeros_in_4 ? std::byte{0} : static_cast<std::byte>(random());
  }
  return bytes;
}

TEST(Frame, RoundTripsEveryLength) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size <= kMaxPayload; ++size) {
    for (unsigned zeros = 0; zeros <= 4U; ++zeros) {
      const Bytes payload = random_bytes(random, size, zeros);
      const FrameHeader header{0x81, 3, static_cast<std::uint16_t>(random()), 0x0100, 0};
      const Bytes frame = encoded(header, payload);
      ASSERT_LE(frame.size(), kMaxEncodedFrame);
      ASSERT_EQ(std::count(frame.begin(), frame.end(), std::byte{0}), 1);
      const Decoded result = decoded(frame);
      ASSERT_EQ(result.frames.size(), 1U) << size << " bytes";
      EXPECT_EQ(result.frames[0].payload, payload);
      EXPECT_EQ(result.frames[0].header.sequence, header.sequence);
      EXPECT_EQ(result.frames[0].header.payload_bytes, size);
    }
  }
}

TEST(Frame, EncodesLongestPayloadWithoutZeros) {
  const Bytes payload(kMaxPayload, std::byte{0x55});
  const Bytes frame = encoded({0x41, 0x22, 0x3333, 0x4444, 0}, payload);
  EXPECT_EQ(frame.size(), kMaxEncodedFrame);
  ASSERT_EQ(decoded(frame).frames.size(), 1U);
}

TEST(Frame, RefusesOversizedPayload) {
  Bytes out(kMaxEncodedFrame);
  EXPECT_EQ(encode_frame({}, Bytes(kMaxPayload + 1U), out), 0U);
  EXPECT_EQ(encode_frame({}, Bytes(1), std::span(out).first(kMaxEncodedFrame - 1U)), 0U);
}

TEST(Frame, RefusesEveryFlippedBit) {
  std::mt19937 random(2);
  const Bytes frame = encoded({0x12, 0, 7, 9, 0}, random_bytes(random, 60, 1));
  const Bytes next = encoded({0x04, 0, 8, 9, 0}, {});
  for (std::size_t bit = 0; bit < 8U * frame.size(); ++bit) {
    Bytes stream = frame;
    stream[bit / 8U] ^= static_cast<std::byte>(1U << (bit % 8U));
    stream.insert(stream.end(), next.begin(), next.end());
    stream.insert(stream.end(), next.begin(), next.end());
    const Decoded result = decoded(stream);
    ASSERT_FALSE(result.frames.empty()) << "bit " << bit;
    for (const Found& found : result.frames) {
      EXPECT_EQ(found.header.kind, 0x04) << "bit " << bit;
    }
  }
}

TEST(Frame, ResynchronisesAfterEveryPrefix) {
  std::mt19937 random(3);
  const Bytes frame = encoded({0x12, 0, 7, 9, 0}, random_bytes(random, 60, 1));
  const Bytes next = encoded({0x04, 0, 8, 9, 0}, {});
  for (std::size_t size = 0; size + 1U < frame.size(); ++size) {
    Bytes stream(frame.begin(), frame.begin() + static_cast<long>(size));
    stream.push_back(std::byte{0});
    stream.insert(stream.end(), next.begin(), next.end());
    const Decoded result = decoded(stream);
    ASSERT_EQ(result.frames.size(), 1U);
    EXPECT_EQ(result.frames[0].header.kind, 0x04);
    EXPECT_EQ(result.damaged, size == 0U ? 0 : 1);
  }
}

TEST(Frame, SkipsInvalidBytes) {
  std::mt19937 random(4);
  const Bytes next = encoded({0x04, 0, 8, 9, 0}, {});
  for (int round = 0; round < 200; ++round) {
    Bytes stream = random_bytes(random, random() % 2000U, 0);
    stream.push_back(std::byte{0});
    stream.insert(stream.end(), next.begin(), next.end());
    const Decoded result = decoded(stream);
    ASSERT_EQ(result.frames.size(), 1U);
  }
}

TEST(Frame, RefusesMismatchedPayloadLength) {
  // The sealed length is wrong, the checksum right: only a sender that errs makes this.
  Bytes raw(sizeof(FrameHeader) + 4U + kFrameChecksumBytes);
  const FrameHeader header{1, 0, 1, 0, 3};
  std::memcpy(raw.data(), &header, sizeof header);
  const std::uint32_t checksum = crc32(std::span(raw).first(raw.size() - 4U));
  std::memcpy(raw.data() + raw.size() - 4U, &checksum, sizeof checksum);
  Bytes stream;  // COBS by hand
  Bytes run;
  const auto flush = [&] {
    stream.push_back(static_cast<std::byte>(run.size() + 1U));
    stream.insert(stream.end(), run.begin(), run.end());
    run.clear();
  };
  for (const std::byte byte : raw) {
    byte == std::byte{0} ? flush() : run.push_back(byte);
  }
  flush();
  stream.push_back(std::byte{0});
  const Decoded result = decoded(stream);
  EXPECT_TRUE(result.frames.empty());
  EXPECT_EQ(result.damaged, 1);
}

TEST(Frame, AcceptsLongerNotShorterMessages) {
  Bytes payload(sizeof(OpenRequest) + 4U);
  OpenRequest request;
  EXPECT_TRUE(decode_message(std::span<const std::byte>(payload), request));
  payload.resize(sizeof(OpenRequest) - 1U);
  EXPECT_FALSE(decode_message(std::span<const std::byte>(payload), request));
}

// Every frame of a session of the first release is decoded, and encoded to the same bytes.
TEST(Frame, EncodesGoldenSessionUnchanged) {
  std::ifstream golden(test::source_folder() / "tests/golden/session-1.0.txt");
  int frames = 0;
  for (std::string line; std::getline(golden, line); ++frames) {
    Bytes frame;
    for (std::size_t i = 2; i + 1 < line.size(); i += 2) {
      frame.push_back(static_cast<std::byte>(std::stoi(line.substr(i, 2), nullptr, 16)));
    }
    const Decoded result = decoded(frame);
    ASSERT_EQ(result.frames.size(), 1U) << line;
    EXPECT_EQ(encoded(result.frames[0].header, result.frames[0].payload), frame) << line;
  }
  EXPECT_GE(frames, 60);
}

TEST(WireStatus, HasUniqueTexts) {
  for (std::uint32_t a = 0; a < kWireStatuses; ++a) {
    for (std::uint32_t b = a + 1U; b <= kWireStatuses; ++b) {
      EXPECT_STRNE(describe(static_cast<WireStatus>(a)), describe(static_cast<WireStatus>(b)));
    }
  }
}

}  // namespace
}  // namespace tactree::core::wire
