#include "tactree/serve/served_target.hpp"

namespace tactree::serve {
namespace {

// Typical of microcontrollers with uniform sectors.
constexpr std::uint32_t kSectorBytes = 16384;
// Maximum number of session steps between two ticks; a frame needs several.
constexpr int kPiecesPerTick = 64;

constexpr char kBoard[] = "host";

hal::FlashGeometry geometry(std::uint32_t slot_bytes) {
  const std::uint32_t sectors = (slot_bytes + kSectorBytes - 1U) / kSectorBytes;
  return {kSectorBytes, 2U + store::kStoreSlots * sectors, 8};
}

/// Board side of a transport.
class TransportPort {
 public:
  explicit TransportPort(client::Transport& transport) : transport_(transport) {}
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    return transport_.read(bytes);
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    return transport_.write(bytes);
  }

 private:
  client::Transport& transport_;
};

}  // namespace

class ServedTarget::Running {
 public:
  Running(hal::sim::SimBoard& board, ServedTarget& target)
      : identity_{kBoard, TACTREE_VERSION, {0, 0, target.options_.serial}, 0},
        port_(target.transport_),
        board_(board, target.mailbox_, target.store_),
        loop_(board_, target.controller_),
        session_({port_, target.store_, target.platform_, target.controller_, target.mailbox_,
                  identity_}) {}

  hal::StartResult start(const core::Configuration& configuration) {
    const hal::StartResult result = loop_.start(configuration);
    session_.started(result, configuration);
    return result;
  }

  core::Status tick() { return loop_.tick().status; }

  void work() {
    for (int i = 0; i < kPiecesPerTick && session_.work(); ++i) {
    }
  }

 private:
  session::BoardIdentity identity_;
  TransportPort port_;
  ServedSimBoard board_;
  hal::Loop<ServedSimBoard> loop_;
  session::Session<TransportPort, ServedSimBoard::Store, ServedPlatform> session_;
};

ServedTarget::ServedTarget(client::Transport& transport, std::span<const std::byte> model,
                           const ServeOptions& options)
    : transport_(transport),
      options_(options),
      flash_(geometry(options.slot_bytes)),
      store_(flash_, {kBoard, options_.key ? options_.key->data() : nullptr, model}) {}

ServedTarget::~ServedTarget() = default;

hal::StartResult ServedTarget::start(hal::sim::SimBoard& board,
                                     const core::Configuration& configuration) {
  (void)store_.mount();
  platform_.start(board);
  running_ = std::make_unique<Running>(board, *this);
  core::Configuration calibrated = configuration;
  store::apply_saved_parameters(store_.parameters(), calibrated);
  return running_->start(calibrated);
}

core::Status ServedTarget::tick(hal::sim::SimBoard&) {
  const core::Status status = running_->tick();
  work();
  return status;
}

void ServedTarget::work() { running_->work(); }

}  // namespace tactree::serve
