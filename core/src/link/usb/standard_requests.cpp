// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/link/usb/standard_requests.hpp"

namespace tactree::core::usb {
namespace {

constexpr std::uint8_t kEndpoints[] = {kBulkOut, kBulkIn, kNewsIn};
constexpr std::uint32_t kSelfPoweredBit = 1;
constexpr std::uint16_t kAddressMax = 127;
constexpr std::uint8_t kConfigurationValue = 1;

constexpr std::uint32_t kDevice = 1;  // descriptor types
constexpr std::uint32_t kConfiguration = 2;
constexpr std::uint32_t kString = 3;
constexpr std::uint32_t kQualifier = 6;
constexpr std::uint32_t kOtherSpeed = 7;
constexpr std::uint32_t kBinaryObjectStore = 15;

/// Bit of an endpoint in halted_; 0 if no endpoint has this address.
std::uint32_t bit_of(std::uint32_t endpoint) {
  for (std::uint32_t i = 0; i < std::size(kEndpoints); ++i) {  // bound: 3
    if (kEndpoints[i] == endpoint) {
      return 1U << i;
    }
  }
  return 0;
}

bool is_control_endpoint(std::uint32_t endpoint) { return (endpoint & 0x7FU) == 0U; }

/// True if a request without data has the form that the standard specifies.
bool is_bare(const SetupPacket& setup) { return !setup.to_host() && setup.wLength == 0; }

bool asks(const SetupPacket& setup, std::uint16_t bytes) {
  return setup.to_host() && setup.wValue == 0 && setup.wLength == bytes;
}

}  // namespace

void StandardRequests::reset(Speed speed) {
  speed_ = speed;
  address_ = 0;
  set_configured(false);
}

void StandardRequests::set_configured(bool configured) {
  configured_ = configured;
  halted_ = 0;
}

bool StandardRequests::is_halted(std::uint8_t endpoint) const {
  return (halted_ & bit_of(endpoint)) != 0U;
}

ControlResponse StandardRequests::setup(const SetupPacket& setup) {
  if (setup.type() == kTypeVendor) {
    const bool asked = setup.to_host() && setup.recipient() == kToDevice &&
                       setup.bRequest == kMicrosoftRequest && setup.wValue == 0 &&
                       setup.wIndex == kMicrosoftDescriptorIndex;
    return asked ? send(microsoft_descriptors(), setup) : stall();
  }
  if (setup.type() != kTypeStandard) {
    return stall();
  }
  if (setup.recipient() == kToDevice) {
    return of_device(setup);
  }
  if (setup.recipient() == kToInterface) {
    return of_interface(setup);
  }
  return setup.recipient() == kToEndpoint ? of_endpoint(setup) : stall();
}

ControlResponse StandardRequests::of_device(const SetupPacket& setup) {
  if (setup.bRequest == kGetDescriptor) {
    return descriptor(setup);
  }
  if (setup.bRequest == kSetAddress) {
    return take_address(setup);
  }
  if (setup.bRequest == kSetConfiguration) {
    return take_configuration(setup);
  }
  if (setup.bRequest == kGetConfiguration && asks(setup, 1) && setup.wIndex == 0) {
    return send_byte(setup, configured_ ? kConfigurationValue : 0);
  }
  if (setup.bRequest == kGetStatus && asks(setup, 2) && setup.wIndex == 0) {
    return status(setup, kSelfPoweredBit);
  }
  return stall();  // no feature of the device can be set, and descriptors cannot be written
}

ControlResponse StandardRequests::of_interface(const SetupPacket& setup) {
  if (!configured_ || setup.wIndex >= kInterfaces) {
    return stall();
  }
  if (setup.bRequest == kGetStatus && asks(setup, 2)) {
    return status(setup, 0);
  }
  if (setup.bRequest == kGetInterface && asks(setup, 1)) {
    return send_byte(setup, 0);
  }
  const bool first = setup.wValue == 0;  // no alternate settings
  if (setup.bRequest == kSetInterface && is_bare(setup) && first) {
    ControlResponse answer = acknowledge();
    if (setup.wIndex == kLinkInterface) {
      halted_ = 0;  // selecting a setting resets its endpoints
      answer.effect = ControlResponse::Effect::kConfigure;
      answer.value = kConfigurationValue;
    }
    return answer;
  }
  return stall();
}

ControlResponse StandardRequests::of_endpoint(const SetupPacket& setup) {
  const bool control = is_control_endpoint(setup.wIndex);
  if (!control && (!configured_ || bit_of(setup.wIndex) == 0U)) {
    return stall();
  }
  if (setup.bRequest == kGetStatus && asks(setup, 2)) {
    return status(setup, (halted_ & bit_of(setup.wIndex)) != 0U ? 1 : 0);
  }
  const bool of_feature = setup.bRequest == kSetFeature || setup.bRequest == kClearFeature;
  if (of_feature && is_bare(setup) && setup.wValue == kEndpointHalt) {
    return control ? acknowledge() : take_halt(setup);
  }
  return stall();
}

ControlResponse StandardRequests::take_halt(const SetupPacket& setup) {
  const bool halt = setup.bRequest == kSetFeature;
  const std::uint32_t bit = bit_of(setup.wIndex);
  halted_ = halt ? halted_ | bit : halted_ & ~bit;
  ControlResponse answer = acknowledge();
  answer.effect = halt ? ControlResponse::Effect::kHalt : ControlResponse::Effect::kClearHalt;
  answer.value = static_cast<std::uint8_t>(setup.wIndex);
  return answer;
}

ControlResponse StandardRequests::take_address(const SetupPacket& setup) {
  if (!is_bare(setup) || setup.wIndex != 0 || setup.wValue > kAddressMax || configured_) {
    return stall();
  }
  address_ = static_cast<std::uint8_t>(setup.wValue);
  ControlResponse answer = acknowledge();
  answer.effect = ControlResponse::Effect::kTakeAddress;
  answer.value = address_;
  return answer;
}

ControlResponse StandardRequests::take_configuration(const SetupPacket& setup) {
  if (!is_bare(setup) || setup.wIndex != 0 || setup.wValue > kConfigurationValue || address_ == 0) {
    return stall();
  }
  set_configured(setup.wValue == kConfigurationValue);
  ControlResponse answer = acknowledge();
  answer.effect = ControlResponse::Effect::kConfigure;
  answer.value = static_cast<std::uint8_t>(setup.wValue);
  return answer;
}

ControlResponse StandardRequests::descriptor(const SetupPacket& setup) {
  if (!setup.to_host()) {
    return stall();
  }
  const std::uint32_t type = setup.wValue >> 8U;
  const auto index = static_cast<std::uint8_t>(setup.wValue & 0xFFU);
  if (type == kString) {
    const auto out = std::span(buffer_).first<kStringBytesMax>();
    const std::size_t size = string_descriptor(index, identity_, out);
    return size == 0 ? stall() : send(out.first(size), setup);
  }
  if (index != 0) {
    return stall();
  }
  if (type == kDevice) {
    const auto device = device_descriptor(identity_);
    __builtin_memcpy(buffer_.data(), device.data(), device.size());
    return send(std::span(buffer_).first(device.size()), setup);
  }
  if (type == kConfiguration) {
    return configuration(setup, speed_, 2);
  }
  if (type == kBinaryObjectStore) {
    return send(bos_descriptor(), setup);
  }
  if (type == kQualifier && has_high_speed_) {
    const auto qualifier = qualifier_descriptor();
    __builtin_memcpy(buffer_.data(), qualifier.data(), qualifier.size());
    return send(std::span(buffer_).first(qualifier.size()), setup);
  }
  if (type == kOtherSpeed && has_high_speed_) {
    return configuration(setup, speed_ == Speed::kFull ? Speed::kHigh : Speed::kFull, 7);
  }
  return stall();
}

ControlResponse StandardRequests::configuration(const SetupPacket& setup, Speed speed,
                                                std::uint8_t type) {
  buffer_ = configuration_descriptor(speed, type);
  return send(buffer_, setup);
}

ControlResponse StandardRequests::status(const SetupPacket& setup, std::uint8_t value) {
  buffer_[0] = static_cast<std::byte>(value);
  buffer_[1] = std::byte{0};
  return send(std::span(buffer_).first(2), setup);
}

ControlResponse StandardRequests::send_byte(const SetupPacket& setup, std::uint8_t value) {
  buffer_[0] = static_cast<std::byte>(value);
  return send(std::span(buffer_).first(1), setup);
}

}  // namespace tactree::core::usb
