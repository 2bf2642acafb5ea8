#pragma once
// The control request: arm, confirm, stop, clear a fault, home. From idle to active takes two
// requests, the second with a token that the reply to the first brought. Not interrupt safe: called
// between ticks only. Cost of each function: constant.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

/// The status of a tick that began after it was requested.
class FreshStatus {
 public:
  void request(TickMailbox& mailbox) {
    before_ = count_;
    mailbox.request_report();
  }
  void note(const core::Status& status) {
    status_ = status;
    ++count_;
  }
  /// One has come since request().
  [[nodiscard]] bool has_come() const { return count_ != before_; }
  /// The newest.
  [[nodiscard]] const core::Status& get() const { return status_; }

 private:
  core::Status status_{};
  std::uint32_t count_ = 0;
  std::uint32_t before_ = 0;
};

class ControlRequests {
 public:
  /// Facts about the moment of a request.
  struct Moment {
    std::uint32_t now_us = 0;
    std::uint16_t session = 0;
    bool flash_busy = false;  ///< an erase is going on
  };

  ControlRequests(const core::Controller& controller, TickMailbox& mailbox)
      : controller_(controller), mailbox_(mailbox) {}

  [[nodiscard]] static bool is_stop(core::wire::MessageKind kind,
                                    std::span<const std::byte> payload);

  /// Posts a stop, ahead of any other command.
  void stop();
  /// Posts the command that a request asks for. A command that the state does not allow would be a
  /// fault for the controller; it is refused here. kBadLength, kBadValue, kBusy, kNotNow,
  /// kBadToken, kQueueFull.
  [[nodiscard]] core::wire::WireStatus post(std::span<const std::byte> payload,
                                            const Moment& moment);
  /// Puts the reply, with the status of a tick after the command.
  void put_reply(const core::Status& status, Reply& reply) const;

  /// Makes the token of the last arming invalid.
  void reset() { token_ = 0; }

 private:
  [[nodiscard]] core::wire::WireStatus arm(const Moment& moment, core::Command& command);
  [[nodiscard]] core::wire::WireStatus confirm(std::uint32_t token, core::Command& command) const;
  [[nodiscard]] core::wire::WireStatus translate(const core::wire::ControlRequest& request,
                                                 const Moment& moment, core::Command& command);
  [[nodiscard]] std::uint32_t make_token(const Moment& moment);

  const core::Controller& controller_;
  TickMailbox& mailbox_;
  std::uint32_t token_ = 0;   // of the last arming; 0: none
  std::uint32_t tokens_ = 0;  // made so far
};

}  // namespace tactree::session
