#include "wire_seeds.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>
#include <vector>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/core/math/crc32.hpp"

namespace {

using namespace tactree::core;
using wire::MessageKind;

/// In the input format of fuzz_wire_session.
class Session {
 public:
  void add(MessageKind kind, std::span<const std::byte> payload = {}) {
    bytes_.push_back(static_cast<char>(kind));
    bytes_.push_back(static_cast<char>(payload.size() % 256U));
    bytes_.push_back(static_cast<char>(payload.size() / 256U));
    const auto* const text = reinterpret_cast<const char*>(payload.data());
    bytes_.insert(bytes_.end(), text, text + payload.size());
  }
  template <wire::Message T>
  void add(MessageKind kind, const T& message) {
    add(kind, std::as_bytes(std::span(&message, 1)));
  }
  void write(const std::filesystem::path& file) const {
    std::ofstream(file, std::ios::binary).write(bytes_.data(), std::ssize(bytes_));
  }

 private:
  std::vector<char> bytes_;
};

void write_each(const std::filesystem::path& folder) {
  Session s;
  s.add(MessageKind::kIdentify);
  s.add(MessageKind::kCapabilities);
  s.add(MessageKind::kHeartbeat, wire::HeartbeatRequest{1000});
  s.add(MessageKind::kSetLimits, wire::SetLimitsRequest{3.0F, 500.0F, 0.1F});
  s.add(MessageKind::kSetMaterial, wire::SetMaterialRequest{300.0F, 0.5F, 0.2F, 0.1F, 1});
  s.add(MessageKind::kSetTexture, wire::SetTextureRequest{1e-4F, 2e-3F});
  s.add(MessageKind::kMoveBody, wire::MoveBodyRequest{});
  s.add(MessageKind::kAddForce, wire::AddForceRequest{{1.0F, 0.0F, 0.0F}, 20});
  s.add(MessageKind::kSubscribe, wire::SubscribeRequest{0x3FF, 2});
  s.add(MessageKind::kControl, wire::ControlRequest{1, {}, 0});
  s.add(MessageKind::kState);
  s.add(MessageKind::kControl, wire::ControlRequest{2, {}, 1});
  s.add(MessageKind::kControl, wire::ControlRequest{3, {}, 0});
  s.add(MessageKind::kReadTrace, wire::ReadTraceRequest{0, 13});
  s.add(MessageKind::kReadFault);
  s.add(MessageKind::kReadStart);
  s.add(MessageKind::kGetParameter, wire::GetParameterRequest{3});
  s.add(MessageKind::kSetParameter, wire::SetParameterRequest{3, 0.1F});
  s.add(MessageKind::kSaveParameters);
  s.add(MessageKind::kClose);
  s.write(folder / "each");
}

// Not a model: the transfer is correct, the final check refuses the data.
void write_model(const std::filesystem::path& folder) {
  const std::vector<std::byte> model(600, std::byte{0x5A});
  Session s;
  wire::BeginModelRequest begin;
  begin.bytes = static_cast<std::uint32_t>(model.size());
  begin.checksum = crc32(model);
  s.add(MessageKind::kListModels);
  s.add(MessageKind::kBeginModel, begin);
  for (std::uint32_t at = 0; at < begin.bytes; at += wire::kMaxPiece) {
    const auto piece =
        std::span(model).subspan(at, std::min<std::size_t>(wire::kMaxPiece, model.size() - at));
    std::vector<std::byte> payload(sizeof at + piece.size());
    std::memcpy(payload.data(), &at, sizeof at);
    std::memcpy(payload.data() + sizeof at, piece.data(), piece.size());
    s.add(MessageKind::kWriteModel, payload);
  }
  s.add(MessageKind::kFinishModel, wire::FinishModelRequest{});
  s.add(MessageKind::kActivateModel, wire::SlotRequest{0});
  s.add(MessageKind::kRollBackModel);
  s.add(MessageKind::kEraseModel, wire::SlotRequest{1});
  s.write(folder / "model");
}

}  // namespace

void write_wire_sessions(const std::filesystem::path& folder) {
  write_each(folder);
  write_model(folder);
}
