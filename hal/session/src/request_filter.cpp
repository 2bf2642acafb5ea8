#include "tactree/session/request_filter.hpp"

namespace tactree::session {

using core::wire::WireStatus;

bool RequestFilter::is_newer(std::uint16_t sequence) const {
  const auto ahead = static_cast<std::uint16_t>(sequence - sequence_);
  return ahead != 0U && ahead < 0x8000U;
}

RequestFilter::Verdict RequestFilter::admit(const core::wire::FrameHeader& request,
                                            bool continued) {
  if (session_ == 0U || request.session != session_) {
    return Verdict::kNoSession;
  }
  if (!continued && !is_newer(request.sequence)) {
    return Verdict::kRepeated;
  }
  sequence_ = request.sequence;
  return Verdict::kAdmitted;
}

void RequestFilter::note_stop(const core::wire::FrameHeader& request) {
  if (request.session == session_ && is_newer(request.sequence)) {
    sequence_ = request.sequence;
  }
}

void RequestFilter::open(const core::wire::OpenRequest& request, std::uint16_t sequence,
                         std::uint32_t now_us) {
  // The first number is taken from the clock, so it is unlikely to be one from before the last
  // reset.
  if (last_session_ == 0U) {
    last_session_ = static_cast<std::uint16_t>(now_us >> 4U);
  }
  ++last_session_;
  last_session_ = last_session_ == 0U ? std::uint16_t{1} : last_session_;
  session_ = last_session_;
  nonce_ = request.nonce;
  minor_ = request.version_minor < core::wire::kProtocolMinor ? request.version_minor
                                                              : core::wire::kProtocolMinor;
  sequence_ = sequence;
}

core::wire::OpenReply RequestFilter::opening(std::uint32_t now_us) const {
  return {core::wire::kProtocolMajor, minor_, session_, nonce_, now_us};
}

WireStatus RequestFilter::known(WireStatus status) const {
  if (minor_ > 0U) {
    return status;
  }
  return status == WireStatus::kNotHomed    ? WireStatus::kNotNow
         : status == WireStatus::kWatchOnly ? WireStatus::kUnsupported
                                            : status;
}

core::Adjustment with_link(core::Adjustment adjustment, const core::Configuration& base,
                           std::uint32_t timeout_ms) {
  adjustment.link.required = base.link.required;
  adjustment.link.timeout_s = base.link.timeout_s;
  if (timeout_ms != 0U) {
    const float timeout_s = 1e-3F * static_cast<float>(timeout_ms);
    const bool shorter = !base.link.required || timeout_s < base.link.timeout_s;
    adjustment.link.required = true;
    adjustment.link.timeout_s = shorter ? timeout_s : base.link.timeout_s;
  }
  return adjustment;
}

bool is_watching(core::wire::MessageKind kind) {
  using Kind = core::wire::MessageKind;
  switch (kind) {
    case Kind::kClose:
    case Kind::kHeartbeat:
    case Kind::kCapabilities:
    case Kind::kState:
    case Kind::kSubscribe:
    case Kind::kListModels:
    case Kind::kReadTrace:
    case Kind::kReadFault:
    case Kind::kGetParameter:
      return true;
    default:
      return false;
  }
}

WireStatus to_wire(core::ConfigurationStatus status) {
  switch (status) {
    case core::ConfigurationStatus::kOk:
      return WireStatus::kOk;
    case core::ConfigurationStatus::kBusy:
      return WireStatus::kBusy;
    case core::ConfigurationStatus::kUnstable:
      return WireStatus::kUnstable;
    default:
      return WireStatus::kBadValue;
  }
}

}  // namespace tactree::session
