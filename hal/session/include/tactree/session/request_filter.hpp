#pragma once
// Checks the session and sequence numbers of requests, which detects late, repeated and forged
// requests. Not interrupt safe: called between ticks only.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"

namespace tactree::session {

class RequestFilter {
 public:
  enum class Verdict : std::uint8_t {
    kAdmitted,
    kNoSession,  ///< not the number of the open session
    kRepeated,   ///< the sequence number is not newer than that of the last request
  };

  /// `continued`: the request was admitted before, and its handler returned Outcome::kLater. The
  /// sequence number of an admitted request is used up.
  [[nodiscard]] Verdict admit(const core::wire::FrameHeader& request, bool continued);
  /// A stop is obeyed without admission. Its sequence number is used up nevertheless, so an arm
  /// request that was sent before the stop but arrives after it is not admitted.
  void note_stop(const core::wire::FrameHeader& request);

  /// Returns true if this request opened the current session, that is, if it is a repetition.
  [[nodiscard]] bool has_opened(const core::wire::OpenRequest& request) const {
    return session_ != 0U && request.nonce == nonce_;
  }
  /// Ends the current session and opens one with a new number. `sequence`: that of the request.
  void open(const core::wire::OpenRequest& request, std::uint16_t sequence, std::uint32_t now_us);
  void close() { session_ = 0; }
  [[nodiscard]] core::wire::OpenReply opening(std::uint32_t now_us) const;

  /// Returns 0 if no session is open.
  [[nodiscard]] std::uint16_t session() const { return session_; }
  /// The status as the session's version of the protocol names it.
  [[nodiscard]] core::wire::WireStatus known(core::wire::WireStatus status) const;

 private:
  [[nodiscard]] bool is_newer(std::uint16_t sequence) const;

  std::uint16_t session_ = 0;
  std::uint16_t last_session_ = 0;
  std::uint16_t sequence_ = 0;  // of the last admitted request
  std::uint8_t minor_ = 0;
  std::uint32_t nonce_ = 0;
};

/// Returns the adjustment with the link required at this timeout. 0 restores the link settings of
/// `base`, the configuration at the start. If `base` requires a link, the shorter timeout applies.
[[nodiscard]] core::Adjustment with_link(core::Adjustment adjustment,
                                         const core::Configuration& base, std::uint32_t timeout_ms);

/// True if the request changes nothing: an application may send it that may only watch. A stop is
/// admitted before.
[[nodiscard]] bool is_watching(core::wire::MessageKind kind);

/// Converts the result of Controller::adjust() and configure() to a wire status.
[[nodiscard]] core::wire::WireStatus to_wire(core::ConfigurationStatus status);

}  // namespace tactree::session
