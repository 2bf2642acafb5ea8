// Writes the frames of a session and their content as decoded by the library, to check a reader
// that was written from docs/PROTOCOL.md alone.
//   record_session SESSION.txt CONTENT.txt
// A line of SESSION.txt is "> hex" to the board or "< hex" from it; the one in CONTENT.txt with the
// same number is kind, status, sequence, session and payload in hex, and some fields by name.

#include <cstdio>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "session_rig.hpp"

namespace {

using namespace tactree;
using Bytes = std::vector<std::byte>;
using core::wire::MessageKind;

std::string hex(std::span<const std::byte> bytes) {
  std::ostringstream out;
  for (const std::byte byte : bytes) {
    out << std::hex << std::setw(2) << std::setfill('0') << static_cast<int>(byte);
  }
  return out.str();
}

/// Fields by the names they have in the page.
std::string fields(std::uint8_t kind, std::span<const std::byte> payload) {
  std::ostringstream out;
  out << std::setprecision(9);
  core::wire::MoveBodyRequest move;
  core::wire::CapabilitiesReply can;
  core::wire::ControlReply control;
  if (kind == static_cast<std::uint8_t>(MessageKind::kMoveBody) &&
      core::wire::decode_message(payload, move)) {
    out << " body=" << move.body << " translation_m[1]=" << move.translation_m[1];
  } else if (kind == (static_cast<std::uint8_t>(MessageKind::kCapabilities) | 0x80) &&
             core::wire::decode_message(payload, can)) {
    out << " rate_hz=" << can.rate_hz << " bodies=" << can.bodies
        << " stiffness_limit_N_m=" << can.stiffness_limit_N_m;
  } else if (kind == (static_cast<std::uint8_t>(MessageKind::kControl) | 0x80) &&
             core::wire::decode_message(payload, control)) {
    out << " state=" << static_cast<int>(control.state) << " token=" << control.token;
  } else if (client::Telemetry t; kind == static_cast<std::uint8_t>(MessageKind::kTelemetry) &&
                                  core::wire::decode_telemetry(payload, t)) {
    out << " tick=" << t.header.tick << " force_N[0]=" << t.force_N[0]
        << " probe_m[0]=" << t.probe_m[0];
  }
  return out.str();
}

void write(const std::vector<Bytes>& frames, char direction, std::ofstream& session,
           std::ofstream& content) {
  for (const Bytes& frame : frames) {
    session << direction << ' ' << hex(frame) << '\n';
    core::wire::FrameDecoder decoder;
    for (const std::byte byte : frame) {
      if (decoder.push(byte) != core::wire::FrameDecoder::Result::kFrame) {
        continue;
      }
      const core::wire::FrameHeader& h = decoder.header();
      content << static_cast<int>(h.kind) << ' ' << static_cast<int>(h.status) << ' ' << h.sequence
              << ' ' << h.session << ' ' << hex(decoder.payload()) << '.'
              << fields(h.kind, decoder.payload()) << '\n';
    }
  }
}

void play(test::SessionRig<>& rig) {
  using core::wire::ControlCode;
  (void)rig.ask(MessageKind::kIdentify);
  (void)rig.open(20);
  (void)rig.ask(MessageKind::kCapabilities);
  (void)rig.ask(MessageKind::kState);
  (void)rig.ask(MessageKind::kListModels);
  (void)rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 5});
  (void)rig.ask(MessageKind::kSetLimits, core::wire::SetLimitsRequest{99.0F, 1.0F, 1.0F});
  (void)rig.arm();
  rig.stand_at(0.0293);
  rig.settle(60);
  core::wire::MoveBodyRequest move;
  move.translation_m[1] = 1e-4F;
  (void)rig.ask(MessageKind::kMoveBody, move);
  (void)rig.ask(MessageKind::kAddForce, core::wire::AddForceRequest{{0.5F, 0.0F, 0.0F}, 20});
  (void)rig.ask(MessageKind::kReadTrace, core::wire::ReadTraceRequest{0, 13});
  (void)rig.ask(MessageKind::kGetParameter, core::wire::GetParameterRequest{3});
  (void)rig.control(ControlCode::kStop);
  (void)rig.ask(MessageKind::kReadFault);
  (void)rig.ask(MessageKind::kClose);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: record_session SESSION.txt CONTENT.txt\n");
    return 2;
  }
  const test::TestBlob blob(test::sphere(0.03, 0.002));
  store::NoModelStore store;
  test::SessionRig<> rig(store, test::SessionRig<>::configuration(), blob.written().bytes);
  play(rig);
  std::ofstream session(argv[1]);
  std::ofstream content(argv[2]);
  write(rig.to_board().sent(), '>', session, content);
  write(rig.to_host().sent(), '<', session, content);
  return session.good() && content.good() ? 0 : 1;
}
