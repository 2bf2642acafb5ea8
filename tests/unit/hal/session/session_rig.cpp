#include "session_rig.hpp"

#include <algorithm>

namespace tactree::test {

void Wire::send(std::span<const std::byte> bytes, std::uint64_t tick) {
  for (const std::byte byte : bytes) {
    begun_.push_back(byte);
    if (byte != static_cast<std::byte>(core::wire::kDelimiter)) {
      continue;
    }
    if (begun_.size() > 1U) {
      sent_.push_back(begun_);
      const std::vector<Delivery> fate =
          spoiler_ ? spoiler_(frames_, tick, begun_) : std::vector<Delivery>{{tick, begun_}};
      on_its_way_.insert(on_its_way_.end(), fate.begin(), fate.end());
      ++frames_;
    }
    begun_.clear();
  }
}

std::vector<std::byte> Wire::arrived(std::uint64_t tick) {
  std::stable_sort(on_its_way_.begin(), on_its_way_.end(),
                   [](const Delivery& a, const Delivery& b) { return a.tick < b.tick; });
  std::vector<std::byte> bytes;
  auto next = on_its_way_.begin();
  for (; next != on_its_way_.end() && next->tick <= tick; ++next) {
    bytes.insert(bytes.end(), next->bytes.begin(), next->bytes.end());
  }
  on_its_way_.erase(on_its_way_.begin(), next);
  return bytes;
}

std::size_t TestPort::read(std::span<std::byte> bytes) noexcept {
  const std::vector<std::byte> arrived = to_board_.arrived(tick_);
  waiting_.insert(waiting_.end(), arrived.begin(), arrived.end());
  const std::size_t count = stuck ? 0U : std::min(bytes.size(), waiting_.size());
  std::copy_n(waiting_.begin(), count, bytes.begin());
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

std::size_t TestPort::write(std::span<const std::byte> bytes) noexcept {
  if (stuck) {
    return 0;
  }
  to_host_.send(bytes, tick_);
  return bytes.size();
}

}  // namespace tactree::test
