#include "tactree/served/usb_board.hpp"

#include <algorithm>
#include <cstring>

#include "tactree/core/blob.hpp"

namespace tactree::served {
namespace {

constexpr std::size_t kModelMax = 64U << 20U;  // bytes

}  // namespace

ModelInMemory::ModelInMemory(core::Controller& controller, std::span<const std::byte> model)
    : controller_(controller), model_(model) {}

core::usb::DfuStatus ModelInMemory::begin() {
  size_ = 0;
  coming_.clear();
  return controller_.motors_off() ? core::usb::DfuStatus::kOk : core::usb::DfuStatus::kTarget;
}

core::usb::DfuStatus ModelInMemory::write(std::uint32_t offset, std::span<const std::byte> bytes) {
  if (offset != size_ || bytes.size() > kModelMax - size_) {
    return core::usb::DfuStatus::kAddress;
  }
  coming_.resize((size_ + bytes.size() + 3) / 4);
  std::memcpy(reinterpret_cast<std::byte*>(coming_.data()) + size_, bytes.data(), bytes.size());
  size_ += bytes.size();
  return core::usb::DfuStatus::kOk;
}

/// The controller first: what it refuses does not replace the model that it has.
core::usb::DfuStatus ModelInMemory::finish() {
  const auto bytes = std::as_bytes(std::span(coming_)).first(std::min(size_, 4 * coming_.size()));
  core::BlobView view;
  if (core::open_blob(bytes, view) != core::BlobStatus::kOk) {
    return core::usb::DfuStatus::kFile;
  }
  if (controller_.load_model(view) != core::ModelStatus::kOk) {
    return core::usb::DfuStatus::kTarget;
  }
  in_use_ = std::move(coming_);
  model_ = std::as_bytes(std::span(in_use_)).first(bytes.size());
  return core::usb::DfuStatus::kOk;
}

core::usb::DfuStatus ModelInMemory::read(std::uint32_t offset, std::span<std::byte> bytes,
                                         std::size_t& count) {
  const std::size_t left = offset < model_.size() ? model_.size() - offset : 0;
  count = std::min(bytes.size(), left);
  if (count != 0) {
    std::memcpy(bytes.data(), model_.data() + offset, count);
  }
  return core::usb::DfuStatus::kOk;
}

UsbBoard::UsbBoard(const core::usb::Identity& usb, const hal::BoardIdentity& identity,
                   std::span<const std::byte> model)
    : model_(core_, model),
      device_(controller_, usb, true, model_, parameters_),
      identity_(identity) {}

std::unique_ptr<simulation::Target> UsbBoard::target() {
  auto target = std::make_unique<Target>(core_, device_, store_, platform_, identity_);
  target_ = target.get();
  return target;
}

void UsbBoard::serve(const core::Status& status) {
  device_.poll(platform_.now_us());
  target_->serve();
  tell(status);
}

void UsbBoard::tell(const core::Status& status) {
  const core::usb::NewsPacket news{status.tick, static_cast<std::uint32_t>(status.state),
                                   status.faults, 0};
  const bool same = news.state == told_.state && news.faults == told_.faults;
  if (!same && device_.tell(news)) {
    told_ = news;
  }
}

}  // namespace tactree::served
