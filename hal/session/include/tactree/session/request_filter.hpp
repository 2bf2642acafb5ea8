#pragma once
// Session and sequence numbers: which requests count, and which session is open. A late, repeated
// or forged request is recognised here. Not interrupt safe: called between ticks only.

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

  /// `continued`: the same request again, after Outcome::kLater. Uses up the sequence number of an
  /// admitted request.
  [[nodiscard]] Verdict admit(const core::wire::FrameHeader& request, bool continued);
  /// A stop is obeyed without admission. Its sequence number is used up all the same, so that an
  /// arm sent before it and received after it is old.
  void note_stop(const core::wire::FrameHeader& request);

  /// The open session was opened by this request: it is a repetition.
  [[nodiscard]] bool has_opened(const core::wire::OpenRequest& request) const {
    return session_ != 0U && request.nonce == nonce_;
  }
  /// Ends the open session, and opens one with a number that no session had before. `sequence`: of
  /// the request.
  void open(const core::wire::OpenRequest& request, std::uint16_t sequence, std::uint32_t now_us);
  void close() { session_ = 0; }
  [[nodiscard]] core::wire::OpenReply opening(std::uint32_t now_us) const;

  /// 0: none is open.
  [[nodiscard]] std::uint16_t session() const { return session_; }

 private:
  [[nodiscard]] bool is_newer(std::uint16_t sequence) const;

  std::uint16_t session_ = 0;
  std::uint16_t last_session_ = 0;
  std::uint16_t sequence_ = 0;  // of the last request that counted
  std::uint8_t minor_ = 0;
  std::uint32_t nonce_ = 0;
};

/// The adjustment with the link required with this timeout; 0: as at the start (`base`). A link
/// that the board requires stays required, with the shorter of both timeouts.
[[nodiscard]] core::Adjustment with_link(core::Adjustment adjustment,
                                         const core::Configuration& base, std::uint32_t timeout_ms);

/// The wire status for the result of Controller::adjust() and configure().
[[nodiscard]] core::wire::WireStatus to_wire(core::ConfigurationStatus status);

}  // namespace tactree::session
