#pragma once
// A register of the faked chip: a value, with side effects of reads and writes.

#include <cstdint>
#include <functional>

namespace tactree::test {

class FakeWord {
 public:
  using OnRead = std::function<std::uint32_t(std::uint32_t value)>;
  using OnWrite = std::function<std::uint32_t(std::uint32_t value, std::uint32_t written)>;

  FakeWord() = default;
  FakeWord(const FakeWord&) = delete;

  operator std::uint32_t() const { return on_read ? on_read(value) : value; }
  FakeWord& operator=(std::uint32_t written) {
    value = on_write ? on_write(value, written) : written;
    return *this;
  }

  std::uint32_t value = 0;  ///< past the hooks: the hardware's own view
  OnRead on_read;           ///< what a driver reads
  OnWrite on_write;         ///< the value after a write
};

/// Adds a condition to a register: while `clocked` is false it reads as zero and ignores writes, as
/// a part without clock. Call after the hooks are set.
inline void gate(FakeWord& word, const std::function<bool()>& clocked) {
  word.on_read = [clocked, inner = word.on_read](std::uint32_t value) {
    return !clocked() ? 0U : inner ? inner(value) : value;
  };
  word.on_write = [clocked, inner = word.on_write](std::uint32_t value, std::uint32_t written) {
    return !clocked() ? value : inner ? inner(value, written) : written;
  };
}

}  // namespace tactree::test
