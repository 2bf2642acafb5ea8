// A client with a board of an older minor version of the protocol.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>

#include "tactree/client/board.hpp"
#include "tactree/core/link/wire/telemetry.hpp"

namespace tactree::test {
namespace {

using core::wire::MessageKind;
using core::wire::WireStatus;

constexpr std::uint32_t kFieldsOf10 = 0x3FF;

/// A board that speaks version 1.0: it opens a session, and refuses fields that it does not know.
/// Has no texture. Answers every other request with success and without a payload.
class OldBoard : public client::Transport {
 public:
  explicit OldBoard(std::uint32_t& subscribed) : subscribed_(subscribed) {}

  std::size_t read(std::span<std::byte> bytes) override {
    const std::lock_guard lock(mutex_);
    const std::size_t size = std::min(bytes.size(), replies_.size());
    std::copy_n(replies_.begin(), size, bytes.begin());
    replies_.erase(replies_.begin(), replies_.begin() + static_cast<std::ptrdiff_t>(size));
    return size;
  }
  std::size_t write(std::span<const std::byte> bytes) override {
    const std::lock_guard lock(mutex_);
    for (const std::byte byte : bytes) {
      if (decoder_.push(byte) == core::wire::FrameDecoder::Result::kFrame) {
        answer();
      }
    }
    return bytes.size();
  }
  void wait(std::chrono::microseconds timeout) override {
    const std::lock_guard lock(mutex_);
    now_ += timeout;
  }
  [[nodiscard]] std::chrono::microseconds now() const override {
    const std::lock_guard lock(mutex_);
    return now_;
  }
  [[nodiscard]] bool in_lock_step() const override { return true; }
  [[nodiscard]] bool connected() const override { return true; }
  [[nodiscard]] std::string name() const override { return "old board"; }

 private:
  void answer() {
    const core::wire::FrameHeader request = decoder_.header();
    const auto kind = static_cast<MessageKind>(request.kind);
    if (kind == MessageKind::kOpen) {
      core::wire::OpenRequest opened;
      (void)core::wire::decode_message(decoder_.payload(), opened);
      const core::wire::OpenReply reply{1, 0, 7, opened.nonce, 0};
      return send(request, WireStatus::kOk, std::as_bytes(std::span(&reply, 1)));
    }
    WireStatus status = WireStatus::kOk;
    if (kind == MessageKind::kSubscribe) {
      core::wire::SubscribeRequest wanted;
      (void)core::wire::decode_message(decoder_.payload(), wanted);
      status = (wanted.fields & ~kFieldsOf10) == 0U ? WireStatus::kOk : WireStatus::kBadValue;
      subscribed_ = wanted.fields;
    }
    if (kind == MessageKind::kSetTexture) {
      status = WireStatus::kUnknownKind;
    }
    send(request, status, {});
  }
  void send(const core::wire::FrameHeader& request, WireStatus status,
            std::span<const std::byte> payload) {
    std::array<std::byte, core::wire::kMaxEncodedFrame> frame{};
    const std::size_t size = core::wire::encode_frame(
        {static_cast<std::uint8_t>(request.kind | core::wire::kReplyBit),
         static_cast<std::uint8_t>(status), request.sequence, request.session, 0},
        payload, frame);
    replies_.insert(replies_.end(), frame.begin(),
                    frame.begin() + static_cast<std::ptrdiff_t>(size));
  }

  mutable std::mutex mutex_;
  std::chrono::microseconds now_{0};
  core::wire::FrameDecoder decoder_;
  std::deque<std::byte> replies_;
  std::uint32_t& subscribed_;
};

TEST(OlderBoard, GetsOnlyFieldsItKnows) {
  std::uint32_t subscribed = 0;
  client::Board board(std::make_unique<OldBoard>(subscribed), {});
  EXPECT_EQ(board.connection().protocol_minor(), 0U);
  board.subscribe({core::wire::kAllTelemetry, 1});
  EXPECT_EQ(subscribed, kFieldsOf10);
}

TEST(OlderBoard, SaysThatItHasNoTexture) {
  std::uint32_t subscribed = 0;
  client::Board board(std::make_unique<OldBoard>(subscribed), {});
  try {
    board.set_texture({1e-4F, 2e-3F});
    FAIL() << "accepted";
  } catch (const client::LinkError& error) {
    EXPECT_STREQ(error.what(), "old board: set texture: the board does not know this message");
  }
}

}  // namespace
}  // namespace tactree::test
