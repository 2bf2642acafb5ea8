#pragma once
// The control request: arm, confirm, stop, clear a fault, home. The transition from idle to active
// requires two requests; the second returns a token from the reply to the first. Not interrupt
// safe: called between ticks only. Cost of each function: constant.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

/// The status of a tick that began after request(). Reports that were queued before do not count.
class FreshStatus {
 public:
  void request(TickMailbox& mailbox) {
    has_come_ = false;
    mailbox.request_report();
  }
  void note(const TickReport& report) {
    status_ = report.status;
    has_come_ |= report.requested;
  }
  /// Returns true once such a status has arrived.
  [[nodiscard]] bool has_come() const { return has_come_; }
  /// The newest status.
  [[nodiscard]] const core::Status& get() const { return status_; }

 private:
  core::Status status_{};
  bool has_come_ = false;
};

class ControlRequests {
 public:
  /// Conditions at the time of a request.
  struct Moment {
    std::uint32_t now_us = 0;
    std::uint16_t session = 0;
    bool flash_busy = false;  ///< an erase is in progress
  };

  ControlRequests(const core::Controller& controller, TickMailbox& mailbox)
      : controller_(controller), mailbox_(mailbox) {}

  [[nodiscard]] static bool is_stop(core::wire::MessageKind kind,
                                    std::span<const std::byte> payload);

  /// Posts a stop, ahead of any other command.
  void stop();
  /// Posts the requested command. A command that the state does not allow is refused here, because
  /// the controller would latch a fault. Errors: kBadLength, kBadValue, kBusy, kNotNow, kNotHomed,
  /// kBadToken, kQueueFull.
  [[nodiscard]] core::wire::WireStatus post(std::span<const std::byte> payload,
                                            const Moment& moment);
  /// Writes the reply, with the status of a tick after the command.
  void put_reply(const core::Status& status, Reply& reply) const;

  /// Invalidates the token of the last arm request.
  void reset() { token_ = 0; }

 private:
  [[nodiscard]] core::wire::WireStatus arm(const Moment& moment, core::Command& command);
  [[nodiscard]] core::wire::WireStatus confirm(std::uint32_t token, core::Command& command) const;
  [[nodiscard]] core::wire::WireStatus translate(const core::wire::ControlRequest& request,
                                                 const Moment& moment, core::Command& command);
  [[nodiscard]] std::uint32_t make_token(const Moment& moment);

  const core::Controller& controller_;
  TickMailbox& mailbox_;
  std::uint32_t token_ = 0;   // of the last arm request; 0: none
  std::uint32_t tokens_ = 0;  // number of tokens made so far
};

}  // namespace tactree::session
