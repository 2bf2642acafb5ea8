#pragma once
// The requests that concern the model store: list, write, check, use, roll back, erase; and keeping
// parameters, which lie beside the models. Nothing is written or erased unless the motors are off.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/controller.hpp"
#include "tactree/core/parameters.hpp"
#include "tactree/core/wire/messages.hpp"
#include "tactree/hal/session/reply.hpp"
#include "tactree/hal/session/tick_mailbox.hpp"

namespace tactree::hal {

enum class TransferStep : std::uint8_t {
  kDone,
  kMore,  ///< to be handled again
};

template <class Store, class Platform>
class ModelTransfer {
 public:
  using Kind = core::wire::MessageKind;
  using WireStatus = core::wire::WireStatus;

  ModelTransfer(Store& store, Platform& platform, core::Controller& controller,
                TickMailbox& mailbox)
      : store_(store), platform_(platform), controller_(controller), mailbox_(mailbox) {}

  /// A transfer that was begun is given up.
  void release() {
    if constexpr (Store::kSlots > 0U) {
      store_.release(this);
    }
  }

  /// Is the flash at work?
  [[nodiscard]] bool is_writing() const {
    if constexpr (Store::kSlots > 0U) {
      return store_.is_erasing();
    }
    return false;
  }

  /// `step` counts from 0 for each request.
  TransferStep handle(Kind kind, std::span<const std::byte> payload, std::uint32_t step,
                      Reply& reply) {
    if constexpr (Store::kSlots == 0U) {
      reply.refuse(is_known(kind) ? WireStatus::kUnsupported : WireStatus::kUnknownKind);
      return TransferStep::kDone;
    } else {
      if (is_known(kind) && kind != Kind::kListModels && !controller_.motors_off()) {
        reply.refuse(WireStatus::kBusy);
        return TransferStep::kDone;
      }
      mailbox_.set_storage_busy(true);
      const TransferStep result = dispatch(kind, payload, step, reply);
      mailbox_.set_storage_busy(result == TransferStep::kMore);
      return result;
    }
  }

 private:
  static bool is_known(Kind kind) {
    return (kind >= Kind::kListModels && kind <= Kind::kEraseModel) ||
           kind == Kind::kSaveParameters;
  }

  TransferStep dispatch(Kind kind, std::span<const std::byte> payload, std::uint32_t step,
                        Reply& reply) {
    switch (kind) {
      case Kind::kListModels:
        return list(reply);
      case Kind::kBeginModel:
        return begin(payload, step, reply);
      case Kind::kWriteModel:
        return write(payload, reply);
      case Kind::kFinishModel:
        return finish(payload, reply);
      case Kind::kActivateModel:
        return activate(payload, reply);
      case Kind::kRollBackModel:
        return use(store_.other_slot(), reply);
      case Kind::kEraseModel:
        return erase(payload, step, reply);
      case Kind::kSaveParameters:
        return save(reply);
      default:
        return done(WireStatus::kUnknownKind, reply);
    }
  }

  static TransferStep done(WireStatus status, Reply& reply) {
    reply.refuse(status);
    return TransferStep::kDone;
  }

  TransferStep list(Reply& reply) {
    reply.put(store_.list());
    return TransferStep::kDone;
  }

  TransferStep begin(std::span<const std::byte> payload, std::uint32_t step, Reply& reply) {
    core::wire::BeginModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    const WireStatus status = step == 0U ? store_.begin(request, this) : store_.erase_next();
    if (status != WireStatus::kOk) {
      return done(status, reply);
    }
    if (store_.is_erasing()) {
      return TransferStep::kMore;
    }
    reply.put(core::wire::BeginModelReply{store_.transfer_slot()});
    return TransferStep::kDone;
  }

  TransferStep write(std::span<const std::byte> payload, Reply& reply) {
    core::wire::WriteModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    reply.refuse(store_.write(request.offset, payload.subspan(sizeof request), this));
    reply.put(core::wire::WriteModelReply{store_.next_offset()});
    return TransferStep::kDone;
  }

  // The bytes are what was announced; are they a model that this controller can use? The controller
  // is asked again when it gets it.
  TransferStep finish(std::span<const std::byte> payload, Reply& reply) {
    core::wire::FinishModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    core::wire::FinishModelReply answer;
    answer.slot = store_.transfer_slot();
    core::BlobStatus blob = core::BlobStatus::kOk;
    reply.refuse(store_.finish(request, blob, this));
    answer.blob = static_cast<std::uint8_t>(blob);
    reply.put(answer);
    return TransferStep::kDone;
  }

  TransferStep activate(std::span<const std::byte> payload, Reply& reply) {
    core::wire::SlotRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    return use(request.slot, reply);
  }

  // The controller first: what it refuses does not get into the record. Where the record fails, the
  // controller goes on with the new model until the next reset, and the reply says so.
  TransferStep use(std::uint32_t slot, Reply& reply) {
    core::wire::FinishModelReply answer;
    answer.slot = slot;
    core::BlobView view;
    core::BlobStatus blob = core::BlobStatus::kOk;
    const WireStatus status = store_.open(slot, view, blob);
    if (status != WireStatus::kOk) {
      return done(status, reply);
    }
    platform_.hold_ticks(true);
    const core::ModelStatus model = controller_.load_model(view);
    platform_.hold_ticks(false);
    answer.model = static_cast<std::uint8_t>(model);
    reply.refuse(model == core::ModelStatus::kOk ? store_.activate(slot) : WireStatus::kBadModel);
    reply.put(answer);
    return TransferStep::kDone;
  }

  TransferStep erase(std::span<const std::byte> payload, std::uint32_t step, Reply& reply) {
    core::wire::SlotRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    const WireStatus status =
        step == 0U ? store_.begin_erase(request.slot, this) : store_.erase_next();
    reply.refuse(status);
    return status == WireStatus::kOk && store_.is_erasing() ? TransferStep::kMore
                                                            : TransferStep::kDone;
  }

  TransferStep save(Reply& reply) {
    float values[core::kParameters];
    for (std::uint32_t i = 0; i < core::kParameters; ++i) {  // bound: kParameters
      values[i] = core::parameter_of(controller_.configuration(), i);
    }
    return done(store_.save_parameters(values), reply);
  }

  Store& store_;
  Platform& platform_;
  core::Controller& controller_;
  TickMailbox& mailbox_;
};

}  // namespace tactree::hal
