#pragma once
// Requests to the model store: list, write, check, activate, roll back, erase, save parameters.
// Flash is written or erased only while the motors are off. Not interrupt safe: called between
// ticks only.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/configuration/parameters.hpp"
#include "tactree/core/control/between_ticks.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/session/reply.hpp"
#include "tactree/session/tick_mailbox.hpp"

namespace tactree::session {

template <class Store, class Platform>
class ModelTransfer {
 public:
  using Kind = core::wire::MessageKind;
  using WireStatus = core::wire::WireStatus;

  /// Keeps all of these references.
  ModelTransfer(Store& store, core::BetweenTicks<Platform>& changes, TickMailbox& mailbox)
      : store_(store), changes_(changes), mailbox_(mailbox) {}

  /// Aborts a transfer of this session.
  void release() {
    if constexpr (Store::kSlots > 0U) {
      store_.release(this);
    }
  }

  /// Returns true while an erase is in progress.
  [[nodiscard]] bool is_writing() const {
    if constexpr (Store::kSlots > 0U) {
      return store_.is_erasing();
    }
    return false;
  }

  /// `step`: number of earlier calls for this request.
  Outcome handle(Kind kind, std::span<const std::byte> payload, std::uint32_t step, Reply& reply) {
    if constexpr (Store::kSlots == 0U) {
      reply.set_status(is_known(kind) ? WireStatus::kUnsupported : WireStatus::kUnknownKind);
      return Outcome::kAnswer;
    } else {
      if (is_known(kind) && kind != Kind::kListModels && !changes_.controller().motors_off()) {
        reply.set_status(WireStatus::kBusy);
        return Outcome::kAnswer;
      }
      mailbox_.set_storage_busy(true);
      const Outcome result = dispatch(kind, payload, step, reply);
      mailbox_.set_storage_busy(result == Outcome::kLater);
      return result;
    }
  }

 private:
  static bool is_known(Kind kind) {
    return (kind >= Kind::kListModels && kind <= Kind::kEraseModel) ||
           kind == Kind::kSaveParameters;
  }

  Outcome dispatch(Kind kind, std::span<const std::byte> payload, std::uint32_t step,
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

  static Outcome done(WireStatus status, Reply& reply) {
    reply.set_status(status);
    return Outcome::kAnswer;
  }

  Outcome list(Reply& reply) {
    reply.put(store_.list());
    return Outcome::kAnswer;
  }

  Outcome begin(std::span<const std::byte> payload, std::uint32_t step, Reply& reply) {
    core::wire::BeginModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    const WireStatus status = step == 0U ? store_.begin(request, this) : store_.erase_next();
    if (status != WireStatus::kOk) {
      return done(status, reply);
    }
    if (store_.is_erasing()) {
      return Outcome::kLater;
    }
    reply.put(core::wire::BeginModelReply{store_.transfer_slot()});
    return Outcome::kAnswer;
  }

  Outcome write(std::span<const std::byte> payload, Reply& reply) {
    core::wire::WriteModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    reply.set_status(store_.write(request.offset, payload.subspan(sizeof request), this));
    reply.put(core::wire::WriteModelReply{store_.next_offset()});
    return Outcome::kAnswer;
  }

  // Checks only the stored model; activate() requires that the controller accepts it, too.
  Outcome finish(std::span<const std::byte> payload, Reply& reply) {
    core::wire::FinishModelRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    core::wire::FinishModelReply answer;
    answer.slot = store_.transfer_slot();
    core::BlobStatus blob = core::BlobStatus::kOk;
    reply.set_status(store_.finish(request, blob, this));
    answer.blob = static_cast<std::uint8_t>(blob);
    reply.put(answer);
    return Outcome::kAnswer;
  }

  Outcome activate(std::span<const std::byte> payload, Reply& reply) {
    core::wire::SlotRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    return use(request.slot, reply);
  }

  // The controller loads the model first, so a model that it refuses is not recorded. If writing
  // the record fails, the controller keeps the new model until the next reset, and the reply is
  // kStorageFailed.
  Outcome use(std::uint32_t slot, Reply& reply) {
    core::wire::FinishModelReply answer;
    answer.slot = slot;
    core::BlobView view;
    core::BlobStatus blob = core::BlobStatus::kOk;
    const WireStatus status = store_.open(slot, view, blob);
    if (status != WireStatus::kOk) {
      return done(status, reply);
    }
    const core::ModelStatus model = changes_.load_model(view);
    answer.model = static_cast<std::uint8_t>(model);
    reply.set_status(model == core::ModelStatus::kOk ? store_.activate(slot)
                                                     : WireStatus::kBadModel);
    reply.put(answer);
    return Outcome::kAnswer;
  }

  Outcome erase(std::span<const std::byte> payload, std::uint32_t step, Reply& reply) {
    core::wire::SlotRequest request;
    if (!core::wire::decode_message(payload, request)) {
      return done(WireStatus::kBadLength, reply);
    }
    const WireStatus status =
        step == 0U ? store_.begin_erase(request.slot, this) : store_.erase_next();
    reply.set_status(status);
    return status == WireStatus::kOk && store_.is_erasing() ? Outcome::kLater : Outcome::kAnswer;
  }

  Outcome save(Reply& reply) {
    float values[core::kParameters];
    for (std::uint32_t i = 0; i < core::kParameters; ++i) {  // bound: kParameters
      values[i] = core::parameter_of(changes_.controller().configuration(), i);
    }
    return done(store_.save_parameters(values), reply);
  }

  Store& store_;
  core::BetweenTicks<Platform>& changes_;
  TickMailbox& mailbox_;
};

}  // namespace tactree::session
