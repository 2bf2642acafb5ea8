#pragma once
// Model of the OTG FS core as a device, between a driver and the tokens of a host: RM0090, sections
// 34.13, 34.16 and 34.17. Whatever the manual leaves open is modelled as the worse case for a
// driver.

#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "fake_word.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::test {

enum class Handshake : std::uint8_t { kNone, kAck, kNak, kStall };

using UsbBytes = std::vector<std::uint8_t>;

class FakeUsbOtg {
 public:
  using Block = firmware::stm32f4::OtgFsBlock<FakeWord>;

  // Imperfections.
  bool resets = true;            ///< the core reset ends
  bool reaches_device = true;    ///< device mode is reached
  bool reset_disables = false;   ///< a bus reset disables all endpoints, but empties no FIFO
  std::uint32_t busy_polls = 3;  ///< until a reset, a flush or the end of an endpoint is done

  /// Access that the manual forbids; empty: none.
  std::string violation;
  std::uint64_t accesses = 0;
  /// Called before each access of the driver: what the host does meanwhile.
  std::function<void()> meanwhile;

  FakeUsbOtg() {
    hook_global();
    for (std::uint32_t n = 0; n < kEndpoints; ++n) {
      hook_in(n);
      hook_out(n);
      on_read(block.fifo[n].word, [this](std::uint32_t) { return pop(false); });
      const auto take = [this, n](std::uint32_t, std::uint32_t word) {
        push(n, word);
        return 0U;
      };
      on_write(block.fifo[n].word, take, true);
    }
    reset_core();
  }

  // ---- the bus

  /// The pull-up at D+ is on.
  [[nodiscard]] bool connected() const {
    return (block.gccfg.value & kPhyOn) == kPhyOn && (block.gusbcfg.value & (1U << 30)) != 0U &&
           (block.dctl.value & 2U) == 0U && (block.dcfg.value & 3U) == 3U && !resetting_;
  }
  void begin_bus_reset() {
    suspended_ = false;
    flags_ |= kUsbReset;
    setup_done_due_ = in_control_ = false;
    for (std::uint32_t n = 1; n < kEndpoints; ++n) {
      in_[n].active = out_[n].active = false;
    }
    for (std::uint32_t n = 0; reset_disables && n < kEndpoints; ++n) {
      in_[n].enabled = out_[n].enabled = false;
    }
  }
  void end_bus_reset() { flags_ |= kEnumerated; }
  void suspend(bool on) {
    suspended_ = on;
    flags_ |= on ? kSuspend : kWakeUp;
  }

  Handshake setup(std::uint32_t address, const std::array<std::uint8_t, 8>& packet) {
    if (!hears(address)) {
      return Handshake::kNone;
    }
    if (setups_left_ == 0U) {
      blame("no room for a SETUP packet");
    }
    setups_left_ -= setups_left_ != 0U ? 1U : 0U;
    in_[0].stall = out_[0].stall = false;
    in_[0].nak = out_[0].nak = true;
    in_[0].toggle = out_[0].toggle = 1;
    put_entry(kSetupData, 0, {packet.begin(), packet.end()});
    setup_done_due_ = true;
    in_control_ = true;
    return Handshake::kAck;
  }

  struct InReply {
    Handshake handshake = Handshake::kNone;
    int toggle = 0;
    UsbBytes data;
  };
  /// `heard`: the acknowledgement of the host arrives.
  InReply in(std::uint32_t address, std::uint32_t n, bool heard = true) {
    Endpoint& e = in_[n];
    if (!hears(address) || (n != 0U && !e.active)) {
      return {};
    }
    end_setup_phase(n);
    if (e.stall) {
      return {Handshake::kStall, 0, {}};
    }
    const std::size_t size = std::min<std::size_t>(packet_bytes(in_[n], n), e.to_send);
    std::deque<std::uint32_t>& fifo = sent_[fifo_of(n)];
    const std::size_t words = (size + 3U) / 4U;
    if (!e.enabled || e.nak || fifo.size() < words) {
      return {Handshake::kNak, 0, {}};
    }
    InReply reply{Handshake::kAck, e.toggle, UsbBytes(size)};
    for (std::size_t i = 0; i < size; ++i) {
      reply.data[i] = static_cast<std::uint8_t>(fifo[i / 4U] >> (8U * (i % 4U)));
    }
    if (heard) {
      fifo.erase(fifo.begin(), fifo.begin() + static_cast<long>(words));
      e.to_send -= static_cast<std::uint32_t>(size);
      e.toggle ^= 1;
      if (--e.packets == 0U) {
        e.enabled = false;
        e.intr |= kDone;
      }
      if (n == 0U && size == 0U) {
        address_ = programmed_address();  // the status stage
        in_control_ = false;
      }
    }
    return reply;
  }

  Handshake out(std::uint32_t address, std::uint32_t n, int toggle, const UsbBytes& data) {
    Endpoint& e = out_[n];
    if (!hears(address) || (n != 0U && !e.active)) {
      return Handshake::kNone;
    }
    end_setup_phase(n);
    if (e.stall) {
      return Handshake::kStall;
    }
    if (toggle != e.toggle) {
      return Handshake::kAck;  // sent again: dropped
    }
    const std::size_t words = 1U + (data.size() + 3U) / 4U + 2U;
    if (!e.enabled || e.nak || received_.size() + words + kSetupWords > block.grxfsiz.value) {
      return Handshake::kNak;
    }
    if (data.size() > packet_bytes(e, n)) {
      blame("the host babbles");
    }
    put_entry(kOutData, n, data);
    e.toggle ^= 1;
    if (--e.packets == 0U || data.size() < packet_bytes(e, n)) {
      put_entry(kOutEnd, n, {});
      e.nak = true;
    }
    return Handshake::kAck;
  }

  /// The end of a transfer at an endpoint that the device does not have: a core that fails.
  void stray_end(std::uint32_t n) { put_entry(kOutEnd, n, {}); }
  void stray_data(std::uint32_t n, const UsbBytes& data) { put_entry(kOutData, n, data); }

  /// While `clocked` is false the core is dead.
  void gate_by(const std::function<bool()>& clocked) {
    for (FakeWord* word : {&block.grstctl, &block.gintsts, &block.grxstsp, &block.gccfg,
                           &block.gusbcfg, &block.dctl, &block.dcfg, &block.dsts}) {
      gate(*word, clocked);
    }
  }

  [[nodiscard]] std::size_t waiting_words() const { return received_.size(); }

  Block block;

 private:
  static constexpr std::uint32_t kEndpoints = 4;
  static constexpr std::uint32_t kFifoRam = 320;
  static constexpr std::uint32_t kSetupWords = 10;
  static constexpr std::uint32_t kSettlingReads = 4;
  static constexpr std::uint32_t kPhyOn = (1U << 16) | (1U << 21);
  static constexpr std::uint32_t kUsbReset = 1U << 12, kEnumerated = 1U << 13;
  static constexpr std::uint32_t kSuspend = 1U << 11, kWakeUp = 1U << 31;
  static constexpr std::uint32_t kOutData = 2, kOutEnd = 3, kSetupEnd = 4, kSetupData = 6;
  static constexpr std::uint32_t kEnable = 1U << 31, kDisable = 1U << 30, kSetNak = 1U << 27;
  static constexpr std::uint32_t kDone = 1U, kDisabled = 2U, kSetupDone = 8U, kNakEffective = 0x40U;

  struct Endpoint {
    bool active = false, enabled = false, nak = false, stall = false;
    int toggle = 0;
    std::uint32_t bytes = 0;  // of a packet
    std::uint32_t type = 0, fifo = 0;
    std::uint32_t packets = 0;  // left in the transfer
    std::uint32_t to_write = 0, to_send = 0;
    std::uint32_t intr = 0;
    std::uint32_t disabling = 0;
  };
  struct Received {
    bool is_status = false;
    std::uint32_t word = 0;
  };

  void blame(const std::string& what) {
    if (violation.empty()) {
      violation = what;
    }
  }

  template <class F>
  void on_read(FakeWord& word, F f) {
    word.on_read = [this, f](std::uint32_t value) {
      note_access();
      return f(value);
    };
  }
  template <class F>
  void on_write(FakeWord& word, F f, bool of_fifo = false) {
    word.on_write = [this, f, of_fifo](std::uint32_t value, std::uint32_t written) {
      note_access(of_fifo);
      return f(value, written);
    };
  }
  void note_access(bool of_fifo = false) {
    ++accesses;
    if (words_due_ != 0U && !of_fifo) {
      blame("another access between the words of a transfer");  // errata sheet ES0182
    }
    if (meanwhile) {
      const std::function<void()> act = std::exchange(meanwhile, nullptr);  // not within itself
      act();
      meanwhile = act;
    }
  }

  [[nodiscard]] bool hears(std::uint32_t address) const {
    return connected() && !suspended_ && address == address_;
  }
  [[nodiscard]] std::uint32_t programmed_address() const { return (block.dcfg.value >> 4) & 0x7FU; }
  [[nodiscard]] static std::uint32_t packet_bytes(const Endpoint& e, std::uint32_t n) {
    return n == 0U ? 64U >> (e.bytes & 3U) : e.bytes;
  }
  [[nodiscard]] std::uint32_t fifo_of(std::uint32_t n) const { return n == 0U ? 0U : in_[n].fifo; }

  // ---- global registers

  void hook_global() {
    on_read(block.grstctl, [this](std::uint32_t) { return reset_control(); });
    on_write(block.grstctl, [this](std::uint32_t, std::uint32_t written) {
      begin_reset_or_flush(written);
      return 0U;
    });
    on_read(block.gintsts, [this](std::uint32_t) {
      const bool host = (block.gusbcfg.value & (1U << 30)) == 0U || !reaches_device ||
                        (mode_polls_ != 0U && mode_polls_-- != 0U);
      constexpr std::uint32_t kNoise = (1U << 3) | (1U << 5) | (1U << 26);  // frames, empty FIFOs
      return flags_ | kNoise | (received_.empty() ? 0U : 1U << 4) | (host ? 1U : 0U);
    });
    on_write(block.gintsts, [this](std::uint32_t, std::uint32_t written) {
      flags_ &= ~written;
      return 0U;
    });
    on_write(block.gccfg, [this](std::uint32_t, std::uint32_t written) {
      if (resetting_ || settling_ != 0U) {
        blame("the transceiver is accessed during the reset");
      }
      return written;
    });
    on_write(block.gusbcfg, [this](std::uint32_t, std::uint32_t written) {
      mode_polls_ = 10;
      return written;
    });
    on_read(block.dsts, [this](std::uint32_t) { return (3U << 1) | (suspended_ ? 1U : 0U); });
    on_read(block.grxstsp, [this](std::uint32_t) { return pop(true); });
    // A read returns another address and frame interval than those written (errata sheet ES0182).
    on_read(block.dcfg, [](std::uint32_t value) { return value ^ 0x1FF0U; });
    on_write(block.dcfg, [this](std::uint32_t, std::uint32_t written) {
      if ((written & ~0x7F7U) != 0U) {
        blame("reserved bits or a frame interval in DCFG");
      }
      block.dcfg.value = written;
      if (!in_control_ || programmed_address() == 0U) {
        address_ = programmed_address();
      }
      return written;
    });
    on_write(block.gahbcfg, [this](std::uint32_t, std::uint32_t written) {
      if ((written & 0x21U) != 0U) {
        blame("interrupts or DMA are on");
      }
      return written;
    });
    on_write(block.dctl, [this](std::uint32_t, std::uint32_t written) {
      if ((written & 2U) == 0U) {
        check_fifo_ram();
      }
      return written;
    });
  }

  std::uint32_t reset_control() {
    if (!resets && resetting_) {
      return kCoreReset;
    }
    settling_ -= settling_ != 0U ? 1U : 0U;
    if (busy_ != 0U && --busy_ == 0U) {
      settling_ = resetting_ ? kSettlingReads : 0U;
      resetting_ = false;
      flushing_ = 0;
    }
    return resetting_ ? kCoreReset : (1U << 31) | flushing_;
  }
  void begin_reset_or_flush(std::uint32_t written) {
    if (busy_ != 0U) {
      blame("a reset or flush before the last one has ended");
    }
    busy_ = busy_polls;
    if ((written & kCoreReset) != 0U) {
      reset_core();
      resetting_ = true;
    }
    flushing_ = written & 0x30U;
    const std::uint32_t which = (written >> 6) & 0x1FU;
    if ((written & 0x20U) != 0U) {
      for (std::uint32_t f = 0; f < kEndpoints; ++f) {
        if (which == 0x10U || which == f) {
          check_silence(f);
          sent_[f].clear();
        }
      }
    }
    if ((written & 0x10U) != 0U) {
      received_.clear();
    }
  }
  void check_silence(std::uint32_t fifo) {
    for (std::uint32_t n = 0; n < kEndpoints; ++n) {
      if (fifo_of(n) == fifo && in_[n].enabled && !in_[n].nak) {
        blame("a FIFO is flushed that the host may read");
      }
    }
  }
  void reset_core() {
    in_ = out_ = {};
    received_.clear();
    for (auto& fifo : sent_) {
      fifo.clear();
    }
    flags_ = 0;
    words_due_ = 0;
    address_ = 0;
    setups_left_ = 0;
    setup_done_due_ = in_control_ = false;
    in_[0].active = out_[0].active = true;
    in_[0].nak = out_[0].nak = true;
  }
  void check_fifo_ram() {
    std::uint32_t at = block.grxfsiz.value;
    if (at < 16U) {
      blame("the receive FIFO is too small");
    }
    for (const FakeWord* word : {&block.dieptxf0, &block.dieptxf[0], &block.dieptxf[1]}) {
      const std::uint32_t begin = word->value & 0xFFFFU;
      const std::uint32_t depth = word->value >> 16;
      if (begin < at || depth < 16U) {
        blame("the FIFOs overlap or are too small");
      }
      at = begin + depth;
    }
    if (at > kFifoRam) {
      blame("the FIFOs do not fit");
    }
  }

  // ---- the receive FIFO

  void put_entry(std::uint32_t status, std::uint32_t n, const UsbBytes& data) {
    const auto size = static_cast<std::uint32_t>(data.size());
    received_.push_back({true, n | (size << 4) | (status << 17)});
    for (std::size_t at = 0; at < data.size(); at += 4U) {
      std::uint32_t word = 0xA5A5A5A5U;
      std::memcpy(&word, data.data() + at, std::min<std::size_t>(4U, data.size() - at));
      received_.push_back({false, word});
    }
    if (received_.size() > block.grxfsiz.value) {
      blame("the receive FIFO overflows");
    }
  }
  // The first token after SETUP packets ends their phase.
  void end_setup_phase(std::uint32_t n) {
    if (n == 0U && std::exchange(setup_done_due_, false)) {
      put_entry(kSetupEnd, 0, {});
    }
  }
  std::uint32_t pop(bool status) {
    if (received_.empty() || received_.front().is_status != status) {
      blame(status ? "a status is read where none is" : "data is read where none is");
      return 0;
    }
    const std::uint32_t word = received_.front().word;
    received_.pop_front();
    if (status && (word & 0xFU) < kEndpoints) {
      Endpoint& e = out_[word & 0xFU];
      const std::uint32_t kind = (word >> 17) & 0xFU;
      if (kind == kOutEnd) {
        e.enabled = false;
        e.intr |= kDone;
      } else if (kind == kSetupEnd) {
        e.enabled = false;
        e.intr |= kSetupDone;
      }
    }
    return word;
  }

  // ---- endpoints

  static std::uint32_t control_of(const Endpoint& e) {
    return e.bytes | (e.active ? 1U << 15 : 0U) | (e.nak ? 1U << 17 : 0U) | (e.type << 18) |
           (e.stall ? 1U << 21 : 0U) | (e.fifo << 22) | (e.enabled ? kEnable : 0U);
  }
  void write_control(Endpoint& e, std::uint32_t n, std::uint32_t written) {
    e.bytes = written & (n == 0U ? 3U : 0x7FFU);
    e.active = n == 0U || (written & (1U << 15)) != 0U;
    e.type = n == 0U ? 0U : (written >> 18) & 3U;
    e.fifo = (written >> 22) & 0xFU;
    const bool stall = (written & (1U << 21)) != 0U;
    e.stall = n == 0U ? e.stall || stall : stall;  // of endpoint 0 only a SETUP packet ends it
    if ((written & (1U << 28)) != 0U) {
      e.toggle = 0;
    }
    if ((written & kSetNak) != 0U) {
      e.nak = true;
    } else if ((written & (1U << 26)) != 0U) {
      e.nak = false;
    }
    if ((written & kEnable) != 0U && !e.enabled) {
      e.enabled = true;
      e.disabling = 0;
      e.intr &= ~kNakEffective;
      if (e.packets == 0U) {
        blame("an endpoint is enabled without a packet");
      }
    }
  }

  void hook_in(std::uint32_t n) {
    auto& part = block.in[n];
    on_read(part.ctl, [this, n](std::uint32_t) { return control_of(in_[n]); });
    on_write(part.ctl, [this, n](std::uint32_t, std::uint32_t written) {
      Endpoint& e = in_[n];
      if ((written & kDisable) != 0U) {
        if (!e.enabled || (e.intr & kNakEffective) == 0U) {
          blame("an endpoint is disabled that is not enabled or not silent");
        }
        e.disabling = busy_polls;
      }
      write_control(e, n, written);
      return 0U;
    });
    on_read(part.intr, [this, n](std::uint32_t) {
      Endpoint& e = in_[n];
      if (e.enabled && e.nak) {
        e.intr |= kNakEffective;
      }
      if (e.disabling != 0U && --e.disabling == 0U) {
        e.enabled = false;
        e.intr |= kDisabled;
      }
      return e.intr | (1U << 7);  // its FIFO is empty, as after a reset
    });
    on_write(part.intr, [this, n](std::uint32_t, std::uint32_t written) {
      in_[n].intr &= ~written;
      return 0U;
    });
    on_write(part.tsiz, [this, n](std::uint32_t, std::uint32_t written) {
      Endpoint& e = in_[n];
      if (e.enabled) {
        blame("the size of a transfer is changed while it runs");
      }
      e.packets = (written >> 19) & (n == 0U ? 3U : 0x3FFU);
      e.to_send = e.to_write = written & (n == 0U ? 0x7FU : 0x7FFFFU);
      const std::uint32_t size = packet_bytes(e, n);
      if (e.packets != std::max(1U, (e.to_send + size - 1U) / size)) {
        blame("packets and size of a transfer disagree");
      }
      return written;
    });
    on_read(part.txfsts, [this, n](std::uint32_t) {
      return depth_of(fifo_of(n)) - static_cast<std::uint32_t>(sent_[fifo_of(n)].size());
    });
  }
  void hook_out(std::uint32_t n) {
    auto& part = block.out[n];
    on_read(part.ctl, [this, n](std::uint32_t) { return control_of(out_[n]); });
    on_write(part.ctl, [this, n](std::uint32_t, std::uint32_t written) {
      if ((written & kDisable) != 0U) {
        blame("an OUT endpoint is disabled without the global NAK");
      }
      write_control(out_[n], n, written);
      return 0U;
    });
    on_read(part.intr, [this, n](std::uint32_t) { return out_[n].intr; });
    on_write(part.intr, [this, n](std::uint32_t, std::uint32_t written) {
      out_[n].intr &= ~written;
      return 0U;
    });
    on_write(part.tsiz, [this, n](std::uint32_t, std::uint32_t written) {
      Endpoint& e = out_[n];
      if (e.enabled && !e.nak) {
        blame("the size of a transfer is changed while it runs");
      }
      e.packets = (written >> 19) & (n == 0U ? 1U : 0x3FFU);
      if (n == 0U) {
        setups_left_ = (written >> 29) & 3U;
      }
      return written;
    });
  }

  [[nodiscard]] std::uint32_t depth_of(std::uint32_t fifo) const {
    return (fifo == 0U ? block.dieptxf0.value : block.dieptxf[fifo - 1U].value) >> 16;
  }
  void push(std::uint32_t fifo, std::uint32_t word) {
    for (std::uint32_t n = 0; n < kEndpoints; ++n) {
      Endpoint& e = in_[n];
      if (fifo_of(n) == fifo && e.enabled && e.to_write != 0U) {
        e.to_write -= std::min(4U, e.to_write);
        words_due_ = e.to_write;
        sent_[fifo].push_back(word);
        if (sent_[fifo].size() > depth_of(fifo)) {
          blame("a transmit FIFO overflows");
        }
        return;
      }
    }
    blame("a word is written to a FIFO without a transfer");
  }

  static constexpr std::uint32_t kCoreReset = 1U;

  std::array<Endpoint, kEndpoints> in_, out_;
  std::array<std::deque<std::uint32_t>, kEndpoints> sent_;
  std::deque<Received> received_;
  std::uint32_t flags_ = 0;
  std::uint32_t address_ = 0;
  std::uint32_t setups_left_ = 0;
  std::uint32_t busy_ = 0;
  std::uint32_t flushing_ = 0;
  std::uint32_t mode_polls_ = 0;
  std::uint32_t settling_ = 0;   // reads until the transceiver may be accessed after a reset
  std::uint32_t words_due_ = 0;  // bytes of a transfer that is being written
  bool resetting_ = false;
  bool suspended_ = false;
  bool setup_done_due_ = false;
  bool in_control_ = false;
};

}  // namespace tactree::test
