// Replies of a session over a link without faults.

#include "tactree/session/session.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "session_rig.hpp"

namespace tactree::test {
namespace {

using core::State;
using core::wire::ControlCode;
using core::wire::MessageKind;
using core::wire::WireStatus;

class SessionTest : public ::testing::Test {
 protected:
  static const TestBlob& blob() {
    static const TestBlob kBlob(sphere(0.03, 0.002));
    return kBlob;
  }
  static store::NoModelStore& no_store() {
    static store::NoModelStore store;
    return store;
  }
  SessionRig<> rig{no_store(), SessionRig<>::configuration(), blob().written().bytes};
};

// The reply to a command must not be an older status, which would hide a fault or a token.
TEST(FreshStatus, IgnoresReportsQueuedBefore) {
  session::TickMailbox mailbox;
  session::FreshStatus fresh;
  mailbox.subscribe(1);
  core::Status status;
  for (std::uint32_t tick = 1; tick <= 2U; ++tick) {
    status.tick = tick;
    mailbox.send(status, tick);
  }
  fresh.request(mailbox);
  status.tick = 3;
  mailbox.send(status, 3);
  for (std::uint32_t tick = 1; tick <= 3U; ++tick) {
    ASSERT_NE(mailbox.front(), nullptr);
    fresh.note(*mailbox.front());
    mailbox.pop();
    EXPECT_EQ(fresh.has_come(), tick == 3U);
  }
  EXPECT_EQ(fresh.get().tick, 3U);
}

TEST_F(SessionTest, IdentifiesItselfWithoutSession) {
  const client::Response response = rig.ask(MessageKind::kIdentify);
  core::wire::IdentifyReply reply;
  ASSERT_TRUE(response.ok() && response.read(reply));
  EXPECT_STREQ(reply.board, "test");
  EXPECT_STREQ(reply.firmware, "1.2.3");
  EXPECT_EQ(reply.serial[2], 3U);
}

TEST_F(SessionTest, RefusesOtherMessagesWithoutSession) {
  for (const MessageKind kind :
       {MessageKind::kState, MessageKind::kHeartbeat, MessageKind::kSetLimits,
        MessageKind::kBeginModel, MessageKind::kReadTrace}) {
    EXPECT_EQ(rig.ask(kind).status, WireStatus::kNoSession);
  }
}

TEST_F(SessionTest, ReportsCapabilitiesWithoutSession) {
  core::wire::CapabilitiesReply can;
  ASSERT_TRUE(rig.ask(MessageKind::kCapabilities).read(can));
  EXPECT_EQ(can.rate_hz, 1000.0F);
  EXPECT_FALSE(has_flag(can, core::wire::BoardFlag::kWatchOnly));
}

TEST_F(SessionTest, ChecksMajorVersionOnly) {
  core::wire::OpenRequest request;
  request.version_major = core::wire::kProtocolMajor + 1;
  EXPECT_EQ(rig.ask(MessageKind::kOpen, request).status, WireStatus::kBadVersion);
  request.version_major = core::wire::kProtocolMajor;
  request.version_minor = core::wire::kProtocolMinor + 9;
  const client::Response response = rig.ask(MessageKind::kOpen, request);
  core::wire::OpenReply reply;
  ASSERT_TRUE(response.ok() && response.read(reply));
  EXPECT_EQ(reply.version_minor, core::wire::kProtocolMinor);
}

class UnhomedSessionTest : public SessionTest {
 protected:
  static core::Configuration configuration() {
    core::Configuration c = SessionRig<>::configuration();
    c.device.homing = core::HomingMethod::kGivenPose;
    return c;
  }
  SessionRig<> rig_{no_store(), configuration(), blob().written().bytes};
};

TEST_F(UnhomedSessionTest, RefusesArmUntilHomed) {
  core::wire::OpenRequest older;  // the rig's client has neither session nor nonce yet
  older.version_minor = 0;
  ASSERT_TRUE(rig_.ask(MessageKind::kOpen, older).ok());
  EXPECT_EQ(rig_.control(ControlCode::kArm).status, WireStatus::kNotNow);
  ASSERT_TRUE(rig_.open().ok());
  EXPECT_EQ(rig_.control(ControlCode::kArm).status, WireStatus::kNotHomed);
  EXPECT_EQ(rig_.state(), State::kIdle);
  EXPECT_TRUE(rig_.control(ControlCode::kHome).ok());
  EXPECT_TRUE(rig_.control(ControlCode::kArm).ok());
  EXPECT_EQ(rig_.state(), State::kArmed);
}

TEST_F(SessionTest, ReportsCapabilitiesAndState) {
  ASSERT_TRUE(rig.open().ok());
  core::wire::CapabilitiesReply can;
  ASSERT_TRUE(rig.ask(MessageKind::kCapabilities).read(can));
  EXPECT_EQ(can.rate_hz, 1000.0F);
  EXPECT_EQ(can.force_limit_N, 8.0F);
  EXPECT_EQ(can.bodies, 1U);
  EXPECT_EQ(can.slots, 0U);
  core::wire::StateReply state;
  ASSERT_TRUE(rig.ask(MessageKind::kState).read(state));
  EXPECT_EQ(static_cast<State>(state.state), State::kIdle);
  EXPECT_NEAR(state.probe_m[0], 0.05F, 1e-4F);
}

TEST_F(SessionTest, RequiresTokenToConfirmArming) {
  ASSERT_TRUE(rig.open().ok());
  core::wire::ControlReply armed;
  ASSERT_TRUE(rig.control(ControlCode::kArm).read(armed));
  rig.settle(20);
  EXPECT_EQ(rig.state(), State::kArmed);
  ASSERT_NE(armed.token, 0U);

  // Armed once more is armed: not the confirmation.
  core::wire::ControlReply again;
  ASSERT_TRUE(rig.control(ControlCode::kArm).read(again));
  EXPECT_EQ(again.token, armed.token);
  EXPECT_EQ(rig.state(), State::kArmed);

  EXPECT_EQ(rig.control(ControlCode::kConfirm, 0).status, WireStatus::kBadToken);
  EXPECT_EQ(rig.control(ControlCode::kConfirm, armed.token + 1U).status, WireStatus::kBadToken);
  EXPECT_EQ(rig.state(), State::kArmed);
  EXPECT_TRUE(rig.control(ControlCode::kConfirm, armed.token).ok());
  EXPECT_EQ(rig.state(), State::kActive);

  EXPECT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_EQ(rig.state(), State::kIdle);
  // A token is of one arming.
  EXPECT_EQ(rig.control(ControlCode::kConfirm, armed.token).status, WireStatus::kNotNow);
  ASSERT_TRUE(rig.control(ControlCode::kArm).ok());
  rig.settle(20);
  EXPECT_EQ(rig.control(ControlCode::kConfirm, armed.token).status, WireStatus::kBadToken);
}

TEST_F(SessionTest, RefusesUntimelyMessagesWithoutFault) {
  ASSERT_TRUE(rig.open().ok());
  EXPECT_EQ(rig.control(ControlCode::kConfirm, 5).status, WireStatus::kNotNow);
  EXPECT_EQ(rig.control(static_cast<ControlCode>(99)).status, WireStatus::kBadValue);
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(rig.control(ControlCode::kArm).status, WireStatus::kNotNow);
  EXPECT_EQ(rig.control(ControlCode::kHome).status, WireStatus::kBusy);
  EXPECT_EQ(rig.state(), State::kActive);
  EXPECT_EQ(rig.controller().faults(), 0U);
}

TEST_F(SessionTest, AcceptsStopWithoutSession) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.arm());
  rig.replace_client();
  EXPECT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_EQ(rig.state(), State::kIdle);
}

TEST_F(SessionTest, RefusesSecondSessionUnderForce) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.arm());
  rig.replace_client();
  EXPECT_EQ(rig.open(0, 8).status, WireStatus::kBusy);
  EXPECT_EQ(rig.state(), State::kActive);
  ASSERT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_TRUE(rig.open(0, 8).ok());
}

TEST_F(SessionTest, StopsOnClose) {
  ASSERT_TRUE(rig.open(20).ok());
  ASSERT_TRUE(rig.arm());
  EXPECT_TRUE(rig.ask(MessageKind::kClose).ok());
  rig.settle(2);
  EXPECT_EQ(rig.state(), State::kIdle);
  EXPECT_FALSE(rig.controller().configuration().link.required);
}

// docs/PROTOCOL.md, 6: an application that went without a word does not keep the link required.
TEST_F(SessionTest, EndsAfterSilenceOnceMotorsAreOff) {
  ASSERT_TRUE(rig.open(20).ok());
  ASSERT_TRUE(rig.arm());
  rig.settle(12000);
  EXPECT_EQ(rig.state(), State::kActive) << "with heartbeats";
  rig.replace_client();
  rig.settle(9900);
  EXPECT_EQ(rig.controller().faults(), core::fault_bit(core::Fault::kLinkLost));
  EXPECT_TRUE(rig.controller().configuration().link.required) << "within 10 s";
  rig.settle(200);
  EXPECT_FALSE(rig.controller().configuration().link.required);
  EXPECT_TRUE(rig.open(0, 8).ok());
}

TEST_F(SessionTest, StaysInSilenceWithoutRequiredLink) {
  ASSERT_TRUE(rig.open().ok());
  rig.settle(12000);
  EXPECT_TRUE(rig.ask(MessageKind::kState).ok());
}

TEST_F(SessionTest, LowersLimitsOnlyWhileStopped) {
  ASSERT_TRUE(rig.open().ok());
  EXPECT_TRUE(
      rig.ask(MessageKind::kSetLimits, core::wire::SetLimitsRequest{3.0F, 500.0F, 0.5F}).ok());
  EXPECT_EQ(rig.controller().configuration().limits.force_max_N, 3.0F);
  for (const core::wire::SetLimitsRequest& bad : {core::wire::SetLimitsRequest{8.1F, 500.0F, 0.5F},
                                                  {3.0F, 2001.0F, 0.5F},
                                                  {NAN, 500.0F, 0.5F},
                                                  {3.0F, NAN, 0.5F},
                                                  {3.0F, 500.0F, NAN},
                                                  {-1.0F, 500.0F, 0.5F},
                                                  {3.0F, 500.0F, 11.0F}}) {
    EXPECT_EQ(rig.ask(MessageKind::kSetLimits, bad).status, WireStatus::kBadValue);
  }
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(
      rig.ask(MessageKind::kSetLimits, core::wire::SetLimitsRequest{2.0F, 500.0F, 0.5F}).status,
      WireStatus::kBusy);
  EXPECT_EQ(rig.controller().configuration().limits.force_max_N, 3.0F);
}

TEST_F(SessionTest, ChangesMaterialWhileActive) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.arm());
  EXPECT_TRUE(rig.ask(MessageKind::kSetMaterial,
                      core::wire::SetMaterialRequest{300.0F, 0.5F, 0.1F, 0.05F, 1})
                  .ok());
  EXPECT_EQ(rig.controller().configuration().contact.stiffness_N_m, 300.0F);
  EXPECT_EQ(
      rig.ask(MessageKind::kSetMaterial, core::wire::SetMaterialRequest{1e5F, 0.0F, 0.1F, 0.05F, 1})
          .status,
      WireStatus::kUnstable);
  EXPECT_EQ(
      rig.ask(MessageKind::kSetMaterial, core::wire::SetMaterialRequest{NAN, 0.5F, 0.1F, 0.05F, 1})
          .status,
      WireStatus::kBadValue);
  EXPECT_EQ(rig.state(), State::kActive);
}

TEST_F(SessionTest, ChangesTextureWhileActive) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.arm());
  const float stiffness_N_m = rig.controller().configuration().contact.stiffness_N_m;
  EXPECT_TRUE(rig.ask(MessageKind::kSetTexture, core::wire::SetTextureRequest{2e-4F, 3e-3F}).ok());
  for (const core::wire::SetTextureRequest& bad :
       {core::wire::SetTextureRequest{2e-3F, 3e-3F}, {NAN, 3e-3F}, {1e-4F, NAN}, {1e-4F, 0.0F}}) {
    EXPECT_EQ(rig.ask(MessageKind::kSetTexture, bad).status, WireStatus::kBadValue);
  }
  const core::ContactParameters& contact = rig.controller().configuration().contact;
  EXPECT_EQ(contact.texture_height_m, 2e-4F);
  EXPECT_EQ(contact.texture_wavelength_m, 3e-3F);
  EXPECT_EQ(contact.stiffness_N_m, stiffness_N_m);
  EXPECT_TRUE(rig.ask(MessageKind::kSetMaterial,
                      core::wire::SetMaterialRequest{300.0F, 0.5F, 0.1F, 0.05F, 1})
                  .ok());
  EXPECT_EQ(contact.texture_height_m, 2e-4F);
  EXPECT_EQ(rig.state(), State::kActive);
}

TEST_F(SessionTest, MovesBody) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.arm());
  core::wire::MoveBodyRequest request;
  request.translation_m[0] = 0.019F;  // its surface is 1 mm before the probe
  request.linear_m_s[0] = 0.05F;
  ASSERT_TRUE(rig.ask(MessageKind::kMoveBody, request).ok());
  EXPECT_FALSE(rig.status().rendering.in_contact);
  rig.settle(40);
  EXPECT_TRUE(rig.status().rendering.in_contact);
  request.body = 1;
  EXPECT_EQ(rig.ask(MessageKind::kMoveBody, request).status, WireStatus::kBadValue);
  request.body = 0;
  request.rotation_wxyz[1] = NAN;
  EXPECT_EQ(rig.ask(MessageKind::kMoveBody, request).status, WireStatus::kBadValue);
}

// docs/PROTOCOL.md: what a session sets stays, and a body goes on with its velocity.
TEST_F(SessionTest, KeepsBodiesAcrossSessions) {
  ASSERT_TRUE(rig.open().ok());
  core::wire::MoveBodyRequest request;
  request.translation_m[0] = 0.019F;  // its surface is 1 mm before the probe
  request.linear_m_s[0] = 0.05F;
  ASSERT_TRUE(rig.ask(MessageKind::kMoveBody, request).ok());
  ASSERT_TRUE(rig.ask(MessageKind::kClose).ok());
  EXPECT_FALSE(rig.status().rendering.in_contact);
  rig.settle(40);
  ASSERT_TRUE(rig.open().ok());
  EXPECT_TRUE(rig.status().rendering.in_contact);
  ASSERT_TRUE(rig.ask(MessageKind::kMoveBody, core::wire::MoveBodyRequest{.enabled = 1}).ok());
  rig.settle(5);
  EXPECT_FALSE(rig.status().rendering.in_contact);
}

TEST_F(SessionTest, LimitsAndExpiresExternalForce) {
  ASSERT_TRUE(rig.open().ok());
  const core::wire::AddForceRequest push{{0.0F, 0.0F, 1.5F}, 50};
  EXPECT_EQ(rig.ask(MessageKind::kAddForce, push).status, WireStatus::kNotNow);
  ASSERT_TRUE(rig.arm());
  rig.settle(300);
  ASSERT_TRUE(rig.ask(MessageKind::kAddForce, push).ok());
  rig.settle(10);
  EXPECT_NEAR(rig.status().force.z, 1.5F, 1e-4F);
  rig.settle(50);
  EXPECT_EQ(rig.status().force.z, 0.0F);

  ASSERT_TRUE(
      rig.ask(MessageKind::kAddForce, core::wire::AddForceRequest{{0, 0, 100.0F}, 100}).ok());
  rig.settle(20);
  EXPECT_NEAR(rig.status().force.z, 4.0F, 1e-4F);  // half of force_max_N
  rig.settle(100);
  EXPECT_EQ(rig.status().force.z, 0.0F);

  for (const core::wire::AddForceRequest& bad :
       {core::wire::AddForceRequest{{NAN, 0, 0}, 50}, {{1, 0, 0}, 0}, {{1, 0, 0}, 101}}) {
    EXPECT_EQ(rig.ask(MessageKind::kAddForce, bad).status, WireStatus::kBadValue);
  }
}

TEST_F(SessionTest, SendsRequestedTelemetryFields) {
  ASSERT_TRUE(rig.open().ok());
  std::vector<client::Telemetry> got;
  rig.client().on_telemetry([&](const client::Telemetry& t) { got.push_back(t); });
  ASSERT_TRUE(
      rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{core::wire::kAllTelemetry, 5})
          .ok());
  rig.settle(101);
  ASSERT_GE(got.size(), 20U);
  EXPECT_LE(got.size(), 21U);
  EXPECT_EQ(got[1].header.tick - got[0].header.tick, 5U);
  EXPECT_NEAR(got[0].probe_m[0], 0.05F, 1e-4F);
  EXPECT_EQ(got[0].state, static_cast<std::uint32_t>(State::kIdle));
  EXPECT_EQ(got.back().header.dropped, 0U);

  got.clear();
  ASSERT_TRUE(rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0, 0}).ok());
  rig.settle(2);
  got.clear();
  rig.settle(50);
  EXPECT_TRUE(got.empty());
  EXPECT_EQ(rig.ask(MessageKind::kSubscribe,
                    core::wire::SubscribeRequest{core::wire::kAllTelemetry + 1U, 1})
                .status,
            WireStatus::kBadValue);
}

// USB full speed carries 1 MB/s.
TEST_F(SessionTest, FitsTelemetryIntoFullSpeed) {
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(
      rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{core::wire::kAllTelemetry, 1})
          .ok());
  rig.settle(10);
  EXPECT_LE(4000U * rig.to_host().sent().back().size(), 1'000'000U);
  EXPECT_GE(rig.to_host().sent().back().size(), 160U);
}

TEST_F(SessionTest, ReadsTraceInPieces) {
  ASSERT_TRUE(rig.open().ok());
  const client::Response response =
      rig.ask(MessageKind::kReadTrace, core::wire::ReadTraceRequest{0, 13});
  core::wire::ReadTraceReply reply;
  ASSERT_TRUE(response.ok() && response.read(reply));
  EXPECT_EQ(reply.count, 13U);
  EXPECT_EQ(response.payload.size(), sizeof reply + 13U * 18U);
  core::FlightRecord record;
  std::memcpy(&record, response.payload.data() + sizeof reply, sizeof record);
  EXPECT_NEAR(record.probe[0], 2500, 1);  // 0.05 m in units of 20 um
  EXPECT_EQ(rig.ask(MessageKind::kReadTrace, core::wire::ReadTraceRequest{0, 14}).status,
            WireStatus::kBadValue);
  ASSERT_TRUE(rig.ask(MessageKind::kReadTrace, core::wire::ReadTraceRequest{1000, 3}).read(reply));
  EXPECT_EQ(reply.count, 0U);
}

TEST_F(SessionTest, ReportsFirstFault) {
  ASSERT_TRUE(rig.open().ok());
  rig.board().safety_inputs().press_emergency_stop(true);
  rig.settle(3);
  core::wire::ReadFaultReply fault;
  ASSERT_TRUE(rig.ask(MessageKind::kReadFault).read(fault));
  EXPECT_EQ(fault.faults, core::fault_bit(core::Fault::kEmergencyStop));
  rig.board().safety_inputs().press_emergency_stop(false);
  ASSERT_TRUE(rig.control(ControlCode::kClearFault).ok());
  ASSERT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_EQ(rig.state(), State::kIdle);
}

TEST_F(SessionTest, ReportsStartWithoutSession) {
  core::wire::ReadStartReply start;
  ASSERT_TRUE(rig.ask(MessageKind::kReadStart).read(start));
  EXPECT_EQ(start.missing, 0U);
  EXPECT_EQ(start.by_watchdog, 0U);
  EXPECT_EQ(start.fault_cause, 0U);
  EXPECT_EQ(start.blob, static_cast<std::uint8_t>(core::BlobStatus::kOk));
  rig.start_report.missing = 7;  // noticed later
  rig.start_report.by_watchdog = true;
  rig.start_report.last_fault = {
      3, 4, 5, 6, 7, 8, {9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21}};
  ASSERT_TRUE(rig.ask(MessageKind::kReadStart).read(start));
  EXPECT_EQ(start.missing, 7U);
  EXPECT_EQ(start.by_watchdog, 1U);
  EXPECT_EQ(start.fault_cause, 3U);
  EXPECT_EQ(start.fault_pc, 6U);
  EXPECT_EQ(start.fault_sp, 8U);
  EXPECT_EQ(start.fault_registers[12], 21U);
  EXPECT_EQ(rig.client().session(), 0U) << "it opened a session for that";
}

TEST_F(SessionTest, ListsAndChecksParameters) {
  ASSERT_TRUE(rig.open().ok());
  for (std::uint32_t i = 0; i < core::kParameters; ++i) {
    core::wire::ParameterReply reply;
    ASSERT_TRUE(
        rig.ask(MessageKind::kGetParameter, core::wire::GetParameterRequest{i}).read(reply));
    EXPECT_LE(reply.min, reply.value) << reply.name;
    EXPECT_GE(reply.max, reply.value) << reply.name;
    EXPECT_TRUE(
        rig.ask(MessageKind::kSetParameter, core::wire::SetParameterRequest{i, reply.value}).ok())
        << reply.name;
    EXPECT_EQ(rig.ask(MessageKind::kSetParameter, core::wire::SetParameterRequest{i, NAN}).status,
              WireStatus::kBadValue);
  }
  EXPECT_EQ(rig.ask(MessageKind::kGetParameter, core::wire::GetParameterRequest{core::kParameters})
                .status,
            WireStatus::kBadValue);
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(rig.ask(MessageKind::kSetParameter, core::wire::SetParameterRequest{0, 1.0F}).status,
            WireStatus::kBusy);
}

TEST_F(SessionTest, RefusesEveryShortMessage) {
  ASSERT_TRUE(rig.open().ok());
  for (const MessageKind kind :
       {MessageKind::kHeartbeat, MessageKind::kControl, MessageKind::kSetLimits,
        MessageKind::kSetMaterial, MessageKind::kSetTexture, MessageKind::kMoveBody,
        MessageKind::kAddForce, MessageKind::kSubscribe, MessageKind::kReadTrace,
        MessageKind::kGetParameter, MessageKind::kSetParameter, MessageKind::kOpen}) {
    const std::byte three[3] = {};
    EXPECT_EQ(rig.await(rig.client().send(kind, std::span(three), rig.now_us())).status,
              WireStatus::kBadLength);
  }
  EXPECT_EQ(rig.ask(static_cast<MessageKind>(0x3E)).status, WireStatus::kUnknownKind);
  EXPECT_EQ(rig.ask(MessageKind::kListModels).status, WireStatus::kUnsupported);
}

}  // namespace
}  // namespace tactree::test
