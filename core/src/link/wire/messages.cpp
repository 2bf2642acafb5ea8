#include "tactree/core/link/wire/messages.hpp"

namespace tactree::core::wire {
namespace {

constexpr const char* kWords[kWireStatuses] = {
    "ok",
    "the board does not know this message",
    "the message is too short",
    "the board speaks another major version of the protocol",
    "there is no session, or it has ended",
    "a field is not finite, out of range, or refers to nothing",
    "the controller is armed: stop first",
    "the state does not allow it",
    "stiffer than device, hand and rate allow",
    "not the token that arm returned",
    "the board does not support this",
    "no transfer was begun, or it was aborted",
    "the block does not follow the previous one",
    "the model is larger than the slot",
    "the model was made for another board",
    "the model's counter is older than that of a model used before",
    "the stored data is not the announced data",
    "the model is not valid, or the controller cannot render it",
    "not signed by the key that the board trusts",
    "the transfer ended before the last byte",
    "another session is writing a model",
    "the slot holds no usable model",
    "the slot holds the model in use",
    "writing the flash failed",
    "too many requests at once",
    "the device is not homed: home it first",
    "the board is operated by its button; an application may watch and stop only",
};

}  // namespace

const char* describe(WireStatus status) {
  const auto index = static_cast<std::uint32_t>(status);
  return index < kWireStatuses ? kWords[index] : "unknown status";
}

}  // namespace tactree::core::wire
