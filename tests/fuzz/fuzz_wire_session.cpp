// Requirement P5: for any messages, the board reads only their bytes, answers, and outputs no
// force.
//
// The input is a list of messages: kind, length, payload. They get the session number, ascending
// sequence numbers and a valid checksum here; a message of kind 0xFF is sent unchanged. The board
// has a model store on simulated flash that counts incorrect accesses. The input does not know the
// token for arming, so the board must never become active.

#include <span>
#include <vector>

#include "memory_file.hpp"
#include "session_rig.hpp"
#include "tactree/hal/sim/flash.hpp"
#include "tactree/store/model_store.hpp"

namespace {

using namespace tactree;
using fuzz::require;
using Bytes = std::vector<std::byte>;
using Store = store::ModelStore<hal::sim::SimFlash>;

constexpr std::uint8_t kRaw = 0xFF;
constexpr std::size_t kMaxMessages = 64;

Bytes sealed(std::uint8_t kind, std::uint16_t session, std::uint16_t sequence,
             std::span<const std::byte> payload) {
  Bytes frame(core::wire::kMaxEncodedFrame);
  frame.resize(core::wire::encode_frame({kind, 0, sequence, session, 0}, payload, frame));
  return frame;
}

/// Every message of the board must be complete.
void check_replies(test::Wire& wire) {
  for (const Bytes& frame : wire.sent()) {
    core::wire::FrameDecoder decoder;
    bool whole = false;
    for (const std::byte byte : frame) {
      whole = decoder.push(byte) == core::wire::FrameDecoder::Result::kFrame;
    }
    require(whole, "the board sent a damaged frame");
    if (decoder.header().kind == static_cast<std::uint8_t>(core::wire::MessageKind::kTelemetry)) {
      client::Telemetry telemetry;
      require(core::wire::decode_telemetry(decoder.payload(), telemetry), "telemetry is too short");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::TestBlob blob(test::sphere(0.03, 0.006));
  hal::sim::SimFlash flash({1024, 2 + 2 * 8, 4});
  Store store(flash, {"test", nullptr, {}});
  require(store.mount(), "an empty flash does not mount");
  test::SessionRig<Store> rig(store, test::SessionRig<Store>::configuration(),
                              blob.written().bytes);
  require(rig.open().ok(), "no session");
  std::uint16_t sequence = 100;
  std::span<const std::byte> left = std::as_bytes(std::span(data, size));
  for (std::size_t i = 0; i < kMaxMessages && left.size() >= 3U; ++i) {
    const auto kind = static_cast<std::uint8_t>(left[0]);
    const std::size_t wanted =
        static_cast<std::size_t>(left[1]) + 256U * (static_cast<std::size_t>(left[2]) & 1U);
    left = left.subspan(3);
    const auto payload = left.first(std::min(wanted, left.size()));
    left = left.subspan(payload.size());
    if (kind == kRaw) {
      Bytes raw(payload.begin(), payload.end());
      raw.push_back(std::byte{0});
      rig.to_board().send(raw, rig.ticks());
    } else {
      rig.to_board().send(sealed(kind, rig.client().session(), ++sequence, payload), rig.ticks());
    }
    rig.settle(3);
    require(rig.state() != core::State::kActive, "active without the token");
    require(rig.status().force == core::Vec3{}, "force while it is not active");
  }
  rig.settle(20);
  require(flash.mistakes() == 0U, "written to flash that was not erased");
  check_replies(rig.to_host());
  return 0;
}
