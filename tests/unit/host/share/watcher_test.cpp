// A watching program: the client's side of the protocol connected to a Watcher, without a clock.

#include "tactree/share/watcher.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace tactree::test {
namespace {

using core::wire::MessageKind;
using core::wire::TelemetryField;
using core::wire::WireStatus;
using share::Watcher;

constexpr auto kProbe = static_cast<std::uint32_t>(TelemetryField::kProbe);
constexpr auto kForce = static_cast<std::uint32_t>(TelemetryField::kForce);

class ShareWatcher : public ::testing::Test {
 protected:
  void SetUp() override {
    program.on_telemetry([this](const client::Telemetry& tick) { seen.push_back(tick); });
  }

  void pass_bytes() {
    watcher.receive(program.to_send());
    program.sent(program.to_send().size());
    program.receive(watcher.to_send(), 0);
    watcher.sent(watcher.to_send().size());
  }

  /// The reply to a request. The board answers questions with `board`.
  client::Response call(MessageKind kind, std::span<const std::byte> payload = {}) {
    program.send(kind, payload, 0);
    pass_bytes();
    for (const Watcher::Question& question : watcher.take_questions()) {
      asked.push_back(question);
      watcher.answer(question, board);
    }
    pass_bytes();
    client::Response response;
    if (!program.take(response)) {
      response.timed_out = true;
    }
    return response;
  }
  template <core::wire::Message T>
  client::Response call(MessageKind kind, const T& message) {
    return call(kind, std::as_bytes(std::span(&message, 1)));
  }

  void open() {
    program.open(0, 7, 0);
    pass_bytes();
    client::Response response;
    ASSERT_TRUE(program.take(response) && response.ok());
  }

  template <core::wire::Message T>
  void let_board_answer(const T& message) {
    const auto bytes = std::as_bytes(std::span(&message, 1));
    board.payload.assign(bytes.begin(), bytes.end());
  }

  void tick(std::uint32_t number) {
    share::Snapshot snapshot;
    snapshot.tick.header = {number, 1000 * number, kProbe | kForce, 0};
    snapshot.tick.probe_m[0] = static_cast<float>(number);
    snapshot.tick.force_N[2] = 2.0F;
    watcher.offer(snapshot);
  }

  Watcher watcher;
  client::Client program;
  client::Response board;
  std::vector<Watcher::Question> asked;
  std::vector<client::Telemetry> seen;
};

TEST_F(ShareWatcher, SendsSubscribedFieldsOfEveryNthTick) {
  open();
  tick(1);
  pass_bytes();
  EXPECT_TRUE(seen.empty());
  EXPECT_TRUE(call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 3}).ok());
  for (std::uint32_t number = 5; number <= 12; ++number) {
    tick(number);
  }
  pass_bytes();
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].header.tick, 5U);
  EXPECT_EQ(seen[2].header.tick, 11U);
  EXPECT_EQ(seen[1].probe_m[0], 8.0F);
  EXPECT_EQ(seen[1].header.fields, kProbe);
  EXPECT_EQ(seen[1].force_N[2], 0.0F);
}

TEST_F(ShareWatcher, SendsNoTelemetryAfterTheSessionOrTheSubscription) {
  open();
  (void)call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 1});
  (void)call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 0});
  tick(1);
  (void)call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 1});
  const std::uint16_t session = program.session();
  EXPECT_TRUE(call(MessageKind::kClose).ok());
  tick(2);
  EXPECT_TRUE(watcher.to_send().empty());
  // A program that goes on with the number of the session that it has closed.
  std::array<std::byte, core::wire::kMaxEncodedFrame> frame;
  core::wire::FrameHeader header;
  header.kind = static_cast<std::uint8_t>(MessageKind::kState);
  header.session = session;
  watcher.receive(std::span(frame).first(encode_frame(header, {}, frame)));
  EXPECT_TRUE(watcher.take_questions().empty());
}

TEST_F(ShareWatcher, DropsAndCountsTelemetryOfProgramThatDoesNotRead) {
  open();
  (void)call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 1});
  std::uint32_t number = 0;
  while (!watcher.is_full()) {
    tick(++number);
  }
  const std::size_t waiting = watcher.to_send().size();
  tick(++number);
  tick(++number);
  EXPECT_EQ(watcher.to_send().size(), waiting);
  EXPECT_LE(waiting, Watcher::kMaxWaiting + core::wire::kMaxEncodedFrame);
  pass_bytes();
  tick(++number);
  pass_bytes();
  EXPECT_EQ(seen.back().header.tick, number);
  EXPECT_EQ(seen.back().header.dropped, 2U);
  EXPECT_EQ(seen.size(), number - 2U);
  (void)call(MessageKind::kSubscribe, core::wire::SubscribeRequest{kProbe, 1});
  tick(++number);
  pass_bytes();
  EXPECT_EQ(seen.back().header.dropped, 0U);
}

TEST_F(ShareWatcher, RefusesEveryCommand) {
  open();
  for (const MessageKind kind :
       {MessageKind::kSetLimits, MessageKind::kSetMaterial, MessageKind::kSetTexture,
        MessageKind::kMoveBody, MessageKind::kAddForce, MessageKind::kBeginModel,
        MessageKind::kWriteModel, MessageKind::kFinishModel, MessageKind::kActivateModel,
        MessageKind::kRollBackModel, MessageKind::kEraseModel, MessageKind::kSetParameter,
        MessageKind::kSaveParameters}) {
    EXPECT_EQ(call(kind).status, WireStatus::kWatchOnly) << static_cast<int>(kind);
  }
  for (const auto code : {core::wire::ControlCode::kArm, core::wire::ControlCode::kConfirm,
                          core::wire::ControlCode::kClearFault, core::wire::ControlCode::kHome}) {
    const core::wire::ControlRequest request{static_cast<std::uint8_t>(code), {}, 0};
    EXPECT_EQ(call(MessageKind::kControl, request).status, WireStatus::kWatchOnly);
  }
  EXPECT_EQ(call(static_cast<MessageKind>(0x3F)).status, WireStatus::kUnknownKind);
  EXPECT_TRUE(asked.empty());
  EXPECT_FALSE(watcher.take_stop());
}

TEST_F(ShareWatcher, AsksTheBoardWhatChangesNothing) {
  open();
  board.status = WireStatus::kBadValue;
  for (const MessageKind kind :
       {MessageKind::kState, MessageKind::kListModels, MessageKind::kReadTrace,
        MessageKind::kReadFault, MessageKind::kReadStart, MessageKind::kGetParameter,
        MessageKind::kIdentify}) {
    const std::array payload = {std::byte{3}, std::byte{4}};
    EXPECT_EQ(call(kind, payload).status, WireStatus::kBadValue);
    EXPECT_EQ(asked.back().kind, kind);
    EXPECT_EQ(asked.back().payload, std::vector<std::byte>(payload.begin(), payload.end()));
  }
}

TEST_F(ShareWatcher, SaysThatTheBoardIsShared) {
  core::wire::CapabilitiesReply can;
  can.rate_hz = 4000.0F;
  let_board_answer(can);
  core::wire::CapabilitiesReply got;
  ASSERT_TRUE(call(MessageKind::kCapabilities).read(got));  // without session
  EXPECT_EQ(got.rate_hz, 4000.0F);
  EXPECT_TRUE(has_flag(got, core::wire::BoardFlag::kWatchOnly));
  EXPECT_TRUE(has_flag(got, core::wire::BoardFlag::kShared));
}

TEST_F(ShareWatcher, StopsWithoutSession) {
  core::wire::StateReply state;
  state.state = 2;
  state.faults = 5;
  let_board_answer(state);
  const core::wire::ControlRequest stop{
      static_cast<std::uint8_t>(core::wire::ControlCode::kStop), {}, 0};
  core::wire::ControlReply reply;
  ASSERT_TRUE(call(MessageKind::kControl, stop).read(reply));
  EXPECT_TRUE(watcher.take_stop());
  EXPECT_FALSE(watcher.take_stop());
  EXPECT_EQ(asked.back().kind, MessageKind::kState);
  EXPECT_EQ(reply.state, 2U);
  EXPECT_EQ(reply.faults, 5U);
}

TEST_F(ShareWatcher, NeedsASessionOfItsOwn) {
  EXPECT_EQ(call(MessageKind::kState).status, WireStatus::kNoSession);
  open();
  const std::uint16_t first = program.session();
  open();
  EXPECT_NE(program.session(), first);
  EXPECT_TRUE(call(MessageKind::kState).ok());
}

TEST_F(ShareWatcher, RefusesAnotherMajorVersion) {
  core::wire::OpenRequest request;
  request.version_major = core::wire::kProtocolMajor + 1;
  EXPECT_EQ(call(MessageKind::kOpen, request).status, WireStatus::kBadVersion);
  EXPECT_EQ(call(MessageKind::kOpen).status, WireStatus::kBadLength);
}

TEST_F(ShareWatcher, LimitsRequestsThatWaitForTheBoard) {
  open();
  for (std::size_t i = 0; i <= Watcher::kMaxQuestions; ++i) {
    program.send(MessageKind::kState, std::span<const std::byte>(), 0);
  }
  pass_bytes();
  client::Response response;
  ASSERT_TRUE(program.take(response));
  EXPECT_EQ(response.status, WireStatus::kQueueFull);
  const std::vector<Watcher::Question> questions = watcher.take_questions();
  ASSERT_EQ(questions.size(), Watcher::kMaxQuestions);
  for (const Watcher::Question& question : questions) {
    watcher.answer(question, board);
  }
  pass_bytes();
  while (program.take(response)) {
    EXPECT_TRUE(response.ok());
  }
  EXPECT_TRUE(call(MessageKind::kState).ok());
}

TEST_F(ShareWatcher, DoesNotReplyForABoardThatDoesNot) {
  open();
  board.timed_out = true;
  EXPECT_TRUE(call(MessageKind::kState).timed_out);
  EXPECT_EQ(asked.size(), 1U);
}

}  // namespace
}  // namespace tactree::test
