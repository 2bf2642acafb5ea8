#include "tactree/session/parameter_requests.hpp"

#include <cstdint>

#include "fields.hpp"
#include "tactree/core/configuration/parameters.hpp"

namespace tactree::session {

using core::wire::WireStatus;

void put_parameter(std::uint32_t number, const core::Controller& controller, Reply& reply) {
  const core::Parameter parameter = core::parameter(number);
  core::wire::ParameterReply message;
  message.number = number;
  message.value = core::parameter_of(controller.configuration(), number);
  message.min = parameter.min;
  message.max = parameter.max;
  copy(parameter.name, message.name);
  reply.put(message);
}

WireStatus get_parameter(std::span<const std::byte> payload, const core::Controller& controller,
                         Reply& reply) {
  core::wire::GetParameterRequest request;
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  if (request.number >= core::kParameters) {
    return WireStatus::kBadValue;
  }
  put_parameter(request.number, controller, reply);
  return WireStatus::kOk;
}

WireStatus parameter_change(std::span<const std::byte> payload, const core::Controller& controller,
                            core::wire::SetParameterRequest& request,
                            core::Configuration& changed) {
  if (!core::wire::decode_message(payload, request)) {
    return WireStatus::kBadLength;
  }
  if (!controller.motors_off()) {
    return WireStatus::kBusy;
  }
  changed = controller.configuration();
  const bool set = request.number < core::kParameters &&
                   core::set_parameter(changed, request.number, request.value);
  return set ? WireStatus::kOk : WireStatus::kBadValue;
}

}  // namespace tactree::session
