#pragma once
// The telemetry of a session: its subscription, and a message for each tick report that is due.
// Not interrupt safe: called between ticks only.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/frame_queue.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

class TelemetrySender {
 public:
  explicit TelemetrySender(TickMailbox& mailbox) : mailbox_(mailbox) {}

  /// Errors: kBadLength; kBadValue if a field does not exist.
  [[nodiscard]] core::wire::WireStatus subscribe(std::span<const std::byte> payload);
  void unsubscribe();

  /// Queues a message if the report is due by the subscription. It leaves room for one frame in the
  /// queue, so a reply never waits for telemetry; a message that does not fit is counted as
  /// dropped. Cost: one frame encoded.
  void send(const TickReport& report, std::uint16_t session, FrameQueue& queue);

 private:
  TickMailbox& mailbox_;
  std::uint32_t fields_ = 0;  // 0: no subscription
  std::uint16_t sequence_ = 0;
};

}  // namespace tactree::session
