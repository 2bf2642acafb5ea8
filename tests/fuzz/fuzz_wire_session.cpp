// Promise P5: whatever messages come, the board reads only them, answers, and gives no force.
//
// The input is a list of messages: kind, length, payload. They are sealed here, with the session's
// number and sequence numbers that count: behind a wrong checksum nothing would be reached. A
// message of kind 0xFF is sent as it is, unsealed. The board has a model store on flash that counts
// mistakes. The token of an arming is not given to the input, so the board must never be active.

#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "session_rig.hpp"
#include "tactree/hal/sim/flash.hpp"
#include "tactree/hal/store/model_store.hpp"

namespace {

using namespace tactree;
using Bytes = std::vector<std::byte>;
using Store = hal::ModelStore<hal::sim::SimFlash>;

constexpr std::uint8_t kRaw = 0xFF;
constexpr std::size_t kMostMessages = 64;

// std::abort() in every build: these are findings, not assertions.
void require(bool good, const char* sentence) {
  if (!good) {
    std::fprintf(stderr, "finding: %s\n", sentence);
    std::abort();
  }
}

Bytes sealed(std::uint8_t kind, std::uint16_t session, std::uint16_t sequence,
             std::span<const std::byte> payload) {
  Bytes frame(core::wire::kMaxEncodedFrame);
  frame.resize(core::wire::encode_frame({kind, 0, sequence, session, 0}, payload, frame));
  return frame;
}

/// What the board sends has to be whole, whatever it was asked.
void check_replies(test::Wire& wire) {
  for (const Bytes& frame : wire.sent()) {
    core::wire::FrameDecoder decoder;
    bool whole = false;
    for (const std::byte byte : frame) {
      whole = decoder.push(byte) == core::wire::FrameDecoder::Result::kFrame;
    }
    require(whole, "the board sent a damaged frame");
    if (decoder.header().kind == static_cast<std::uint8_t>(core::wire::MessageKind::kTelemetry)) {
      host::Telemetry telemetry;
      require(host::decode_telemetry(decoder.payload(), telemetry), "telemetry is too short");
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
  for (std::size_t i = 0; i < kMostMessages && left.size() >= 3U; ++i) {
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
