#pragma once
// A full-speed USB device on the OTG FS core of the chip (RM0090, chapter 34; Synopsys DWC2), a
// hal::UsbController. The core is polled: without an interrupt and without DMA it cannot delay a
// tick. Between two calls it answers the host itself: it accepts every SETUP packet, and NAKs all
// that has no data or no room.
//
// Other chips have the same core, but other bits in GCCFG and a FIFO RAM of another size.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"
#include "tactree/hal/usb_device.hpp"

namespace tactree::firmware::stm32f4 {

namespace otg {
// GUSBCFG (section 34.16.2): internal transceiver, device mode whatever the ID pin says, 6 clocks
// of turnaround time for a bus clock of at least 32 MHz.
inline constexpr std::uint32_t kInternalPhy = 1U << 6;
inline constexpr std::uint32_t kDevice = kInternalPhy | (1U << 30) | (6U << 10);
// GRSTCTL.
inline constexpr std::uint32_t kCoreReset = 1U << 0;
inline constexpr std::uint32_t kFlushReceived = 1U << 4;
inline constexpr std::uint32_t kFlushSent = 1U << 5;
inline constexpr std::uint32_t kFifoShift = 6;
inline constexpr std::uint32_t kAllFifos = 0x10;
inline constexpr std::uint32_t kBusIdle = 1U << 31;
// GINTSTS.
inline constexpr std::uint32_t kHostMode = 1U << 0;
inline constexpr std::uint32_t kReceived = 1U << 4;
inline constexpr std::uint32_t kBusReset = 1U << 12;
inline constexpr std::uint32_t kEnumerated = 1U << 13;
// GCCFG: transceiver on; VBUS is not measured.
inline constexpr std::uint32_t kPhyOn = (1U << 16) | (1U << 21);
// DCFG: full speed; a status stage with data is stalled. Address in bits 4 to 10.
inline constexpr std::uint32_t kFullSpeed = 0x3U | (1U << 2);
inline constexpr std::uint32_t kAddressShift = 4;
inline constexpr std::uint32_t kDisconnected = 1U << 1;  // DCTL
inline constexpr std::uint32_t kSuspended = 1U << 0;     // DSTS

// DIEPCTL, DOEPCTL.
inline constexpr std::uint32_t kEnable = 1U << 31;
inline constexpr std::uint32_t kDisable = 1U << 30;
inline constexpr std::uint32_t kData0 = 1U << 28;
inline constexpr std::uint32_t kSetNak = 1U << 27;
inline constexpr std::uint32_t kClearNak = 1U << 26;
inline constexpr std::uint32_t kTxFifoShift = 22;
inline constexpr std::uint32_t kStall = 1U << 21;
inline constexpr std::uint32_t kBulk = 2U << 18;
inline constexpr std::uint32_t kInterrupt = 3U << 18;
inline constexpr std::uint32_t kActive = 1U << 15;
inline constexpr std::uint32_t kControlBytesMask = 0x3U;  // endpoint 0; 0 means 64 bytes
// DIEPINT, DOEPINT.
inline constexpr std::uint32_t kDone = 1U << 0;
inline constexpr std::uint32_t kDisabledNow = 1U << 1;
inline constexpr std::uint32_t kSetupDone = 1U << 3;
inline constexpr std::uint32_t kNakEffective = 1U << 6;
// DIEPTSIZ, DOEPTSIZ: packets, and SETUP packets that endpoint 0 has room for.
inline constexpr std::uint32_t kPacketShift = 19;
inline constexpr std::uint32_t kThreeSetups = 3U << 29;

// Packet status of an entry of the receive FIFO (GRXSTSP).
inline constexpr std::uint32_t kOutData = 2;
inline constexpr std::uint32_t kOutEnd = 3;
inline constexpr std::uint32_t kSetupEnd = 4;
inline constexpr std::uint32_t kSetupData = 6;

// FIFO RAM, 320 words (section 34.13): the receive FIFO needs 10 for SETUP packets, 1, 2 for each
// OUT endpoint and 17 for each packet that waits. The FIFO of the bulk endpoint holds a transfer.
inline constexpr std::uint32_t kReceiveWords = 128;
inline constexpr std::uint32_t kControlWords = 16;
inline constexpr std::uint32_t kLinkWords = 128;
inline constexpr std::uint32_t kNewsWords = 16;
static_assert(kReceiveWords + kControlWords + kLinkWords + kNewsWords <= 320);

// Numbers of polls, of at least ten cycles each: device mode is reached within 25 ms (section
// 34.16.2), a reset or a flush within some clocks of the bus.
inline constexpr std::uint32_t kModePolls = 1000000;
inline constexpr std::uint32_t kPolls = 10000;  // 0.6 ms at 168 MHz
// Reads after a reset of the core: three clocks of the transceiver (section 34.16.2) are 11 cycles.
inline constexpr std::uint32_t kSettlingReads = 8;
}  // namespace otg

/// Call from one context only, outside the tick. Cost of a call: at most kAccessesMax accesses of
/// registers, whatever the host does. A call that ends a transfer before the host has read it also
/// waits for the core: some microseconds, or 2 ms if the core has failed, 6 ms at a bus reset.
template <class Word>
class UsbOtgFs {
 public:
  /// 127 of them write a transfer of the link.
  static constexpr std::uint32_t kAccessesMax = 160;

  explicit UsbOtgFs(OtgFsBlock<Word>& block) : block_(block) {}
  UsbOtgFs(const UsbOtgFs&) = delete;
  UsbOtgFs& operator=(const UsbOtgFs&) = delete;

  /// Connects the device to the bus (section 34.17.1). Preconditions: the core has its clocks, with
  /// 48 MHz from the crystal; the pins have the alternate function. Returns false if the core does
  /// not answer: it then stays disconnected and has no events. Cost: up to 25 ms, 0.1 s after a
  /// failure.
  [[nodiscard]] bool start() {
    set(block_.gusbcfg, otg::kInternalPhy);
    started_ = reset_core();
    if (!started_) {
      return false;
    }
    block_.dctl = otg::kDisconnected;
    block_.gahbcfg = 0U;  // no interrupt
    block_.gusbcfg = otg::kDevice;
    block_.gccfg = otg::kPhyOn;
    block_.pcgcctl = 0U;
    started_ = wait_until(block_.gintsts, otg::kHostMode, 0U, otg::kModePolls);
    block_.dcfg = otg::kFullSpeed;
    divide_fifo_ram();
    started_ = flush_all_sent() && flush(otg::kFlushReceived) && started_;
    set(block_.out[0].tsiz, otg::kThreeSetups);
    if (started_) {
      block_.dctl = 0U;
    }
    return started_;
  }

  /// A suspended bus counts as disconnected: without a measurement of VBUS an unplugged cable looks
  /// the same.
  [[nodiscard]] hal::UsbEvent next_event() {
    using Kind = hal::UsbEvent::Kind;
    if (!started_) {
      return {};
    }
    const std::uint32_t flags = stm32f4::read(block_.gintsts) & (otg::kBusReset | otg::kEnumerated);
    block_.gintsts = flags;  // write 1 to clear
    if ((flags & otg::kBusReset) != 0U) {
      begin_reset();
    }
    if ((flags & otg::kEnumerated) != 0U) {
      in_reset_ = false;
      set_address(0);  // again: a request of the time before the reset may have been answered
      change(block_.in[0].ctl, otg::kControlBytesMask, 0U);
      return {Kind::kReset, core::usb::Speed::kFull, {}};
    }
    receive();
    if (in_reset_) {
      setup_state_ = SetupState::kNone;  // what came before the reset
      stage_ = Stage::kNone;
      return {};
    }
    const bool suspended = has(block_.dsts, otg::kSuspended);
    if (suspended != suspended_) {
      suspended_ = suspended;
      return {suspended ? Kind::kDisconnected : open_ ? Kind::kConfigured : Kind::kNone, {}, {}};
    }
    continue_sending();
    if (setup_state_ == SetupState::kComplete) {
      setup_state_ = SetupState::kNone;
      return {Kind::kSetup, core::usb::Speed::kFull, setup_};
    }
    if (stage_ == Stage::kReceived) {
      stage_ = Stage::kNone;
      return {Kind::kData, core::usb::Speed::kFull, {}};
    }
    return {};
  }

  void control_send(std::span<const std::byte> data, bool end) {
    if (is_superseded()) {
      return;
    }
    left_ = data;
    end_ = end;
    stage_ = Stage::kSending;
    receive_control_packet();  // of the status stage
    send_control_packet();
  }

  /// Stalls a data stage of more bytes than a block of DFU, which no request has.
  void control_receive(std::uint16_t bytes) {
    if (bytes > sizeof control_) {
      control_stall();
    } else if (!is_superseded()) {
      expected_ = bytes;
      received_ = 0;
      stage_ = Stage::kReceiving;
      receive_control_packet();
    }
  }
  [[nodiscard]] std::span<const std::byte> control_data() const {
    return std::span(control_).first(received_);
  }

  void control_acknowledge() {
    if (!is_superseded()) {
      stage_ = Stage::kNone;
      transmit(0, {});
    }
  }

  /// The core ends the stall of endpoint 0 at the next SETUP packet.
  void control_stall() {
    if (!is_superseded()) {
      stage_ = Stage::kNone;
      set(block_.in[0].ctl, otg::kStall);
      set(block_.out[0].ctl, otg::kStall);
    }
  }

  /// The core uses the address after the status stage (section 34.17.5). The register is not read,
  /// because it may return another address (errata sheet ES0182).
  void set_address(std::uint8_t address) {
    block_.dcfg = otg::kFullSpeed | (std::uint32_t{address} << otg::kAddressShift);
  }

  void configure(bool open) {
    receive();
    open_ = open;
    end_transfer(kLink);
    end_transfer(kNews);
    link_size_ = link_next_ = 0;
    if (!open) {
      clear(block_.in[kLink].ctl, otg::kActive);
      clear(block_.in[kNews].ctl, otg::kActive);
      clear(block_.out[kLink].ctl, otg::kActive);
      return;
    }
    const std::uint32_t common = otg::kActive | otg::kData0;
    const std::uint32_t bulk = common | otg::kBulk | core::usb::kBulkPacketBytesFull;
    block_.in[kLink].ctl = bulk | (kLink << otg::kTxFifoShift);
    block_.in[kNews].ctl = common | otg::kInterrupt | (kNews << otg::kTxFifoShift) |
                           std::uint32_t{sizeof(core::usb::NewsPacket)};
    block_.out[kLink].ctl = bulk;
    receive_link_packet();
  }

  /// An IN endpoint drops what was not sent.
  void halt(std::uint8_t endpoint, bool on) {
    const std::uint32_t number = endpoint & 0xFU;
    const bool in = (endpoint & 0x80U) != 0U;
    if (in) {
      end_transfer(number);
    }
    change(in ? block_.in[number].ctl : block_.out[number].ctl, otg::kStall,
           on ? otg::kStall : otg::kData0);
  }

  [[nodiscard]] std::size_t read(std::uint8_t endpoint, std::span<std::byte> bytes) {
    if (!open_ || endpoint != core::usb::kBulkOut) {
      return 0;
    }
    const std::size_t left = link_size_ - link_next_;
    const std::size_t count = bytes.size() < left ? bytes.size() : left;
    __builtin_memcpy(bytes.data(), link_ + link_next_, count);
    link_next_ += count;
    if (link_next_ == link_size_) {
      receive_link_packet();
    }
    return count;
  }

  /// Accepts nothing while a transfer of the endpoint is in progress. Every transfer ends with a
  /// short packet, so that the host returns its bytes at once.
  [[nodiscard]] std::size_t write(std::uint8_t endpoint, std::span<const std::byte> bytes) {
    const std::uint32_t number = endpoint & 0xFU;
    std::size_t size = bytes.size() < kTransferBytes ? bytes.size() : kTransferBytes;
    size -= size % core::usb::kBulkPacketBytesFull == 0U && size != 0U ? 1U : 0U;
    if (!open_ || size == 0U || has(block_.in[number].ctl, otg::kEnable)) {
      return 0;
    }
    transmit(number, bytes.first(size));
    return size;
  }

 private:
  enum class SetupState : std::uint8_t { kNone, kReceived, kComplete };
  enum class Stage : std::uint8_t { kNone, kSending, kReceiving, kReceived };

  static constexpr std::uint32_t kLink = 1;  // number of both bulk endpoints
  static constexpr std::uint32_t kNews = 2;
  static constexpr std::uint32_t kEntries = 16;  // of the receive FIFO in one call
  static constexpr std::size_t kTransferBytes = 508;
  static_assert(kTransferBytes <= 4U * otg::kLinkWords);

  // ---- the core

  bool reset_core() {
    if (!wait_until(block_.grstctl, otg::kBusIdle, otg::kBusIdle, otg::kPolls)) {
      return false;
    }
    set(block_.grstctl, otg::kCoreReset);
    const bool done =
        wait_until(block_.grstctl, otg::kCoreReset | otg::kBusIdle, otg::kBusIdle, otg::kPolls);
    for (std::uint32_t i = 0; i < otg::kSettlingReads; ++i) {  // bound: kSettlingReads
      (void)stm32f4::read(block_.grstctl);
    }
    return done;
  }

  bool flush(std::uint32_t what) {
    block_.grstctl = what;
    return wait_until(block_.grstctl, otg::kFlushSent | otg::kFlushReceived, 0U, otg::kPolls);
  }

  bool flush_all_sent() { return flush(otg::kFlushSent | (otg::kAllFifos << otg::kFifoShift)); }

  void divide_fifo_ram() {
    std::uint32_t begin = otg::kReceiveWords;
    block_.grxfsiz = otg::kReceiveWords;
    block_.dieptxf0 = (otg::kControlWords << 16U) | begin;
    begin += otg::kControlWords;
    block_.dieptxf[kLink - 1U] = (otg::kLinkWords << 16U) | begin;
    begin += otg::kLinkWords;
    block_.dieptxf[kNews - 1U] = (otg::kNewsWords << 16U) | begin;
  }

  // Section 34.17.5. The core has deactivated all endpoints but endpoint 0; whether it has disabled
  // them is not stated. Entries of the receive FIFO are kept: the first SETUP packet after a reset
  // that is seen late may be among them.
  void begin_reset() {
    in_reset_ = true;
    open_ = false;
    receives_link_ = false;
    set(block_.out[0].ctl, otg::kSetNak);
    set(block_.out[kLink].ctl, otg::kSetNak);
    for (std::uint32_t number = 0; number <= kNews; ++number) {  // bound: 3
      end_transfer(number);
    }
    (void)flush_all_sent();
    set_address(0);  // the host may use it before the end of the reset is seen
    set(block_.out[0].tsiz, otg::kThreeSetups);
  }

  // ---- IN endpoints

  /// Drops what was not sent (section 34.17.6). Until the core NAKs, the transfer may still end: it
  /// must not begin again, so kEnable is not written back, and then there is nothing to disable.
  void end_transfer(std::uint32_t number) {
    auto& in = block_.in[number];
    if (has(in.ctl, otg::kEnable)) {
      change(in.ctl, otg::kEnable, otg::kSetNak);
      wait_for_any(in.intr, otg::kNakEffective | otg::kDone);
      if (has(in.ctl, otg::kEnable)) {
        change(in.ctl, otg::kEnable, otg::kDisable | otg::kSetNak);
        wait_for_any(in.intr, otg::kDisabledNow);
      }
      (void)flush(otg::kFlushSent | (number << otg::kFifoShift));
    }
    in.intr = otg::kDisabledNow | otg::kDone;
  }

  static void wait_for_any(const Word& word, std::uint32_t mask) {
    for (std::uint32_t i = 0; i < otg::kPolls && (stm32f4::read(word) & mask) == 0U;
         ++i) {  // bound: kPolls
    }
  }

  /// Between the words of a transfer no other register may be accessed: the core would corrupt the
  /// next word (errata sheet ES0182). A tick, which may interrupt this, accesses none of the core.
  void transmit(std::uint32_t number, std::span<const std::byte> bytes) {
    constexpr std::size_t kPacket = core::usb::kBulkPacketBytesFull;
    auto& in = block_.in[number];
    const auto packets = static_cast<std::uint32_t>((bytes.size() + kPacket - 1U) / kPacket);
    in.intr = otg::kDone;
    in.tsiz = ((packets == 0U ? 1U : packets) << otg::kPacketShift) |
              static_cast<std::uint32_t>(bytes.size());
    set(in.ctl, otg::kEnable | otg::kClearNak);
    while (!bytes.empty()) {  // bound: kTransferBytes / 4
      std::uint32_t word = 0;
      const std::size_t size = bytes.size() < sizeof word ? bytes.size() : sizeof word;
      __builtin_memcpy(&word, bytes.data(), size);
      block_.fifo[number].word = word;
      bytes = bytes.subspan(size);
    }
  }

  // ---- endpoint 0

  /// True if a newer SETUP packet has arrived, whose transfer must not get the answer to the older.
  bool is_superseded() {
    receive();
    return setup_state_ != SetupState::kNone;
  }

  void send_control_packet() {
    const std::size_t size = left_.size() < core::usb::kControlPacketBytes
                                 ? left_.size()
                                 : core::usb::kControlPacketBytes;
    transmit(0, left_.first(size));
    left_ = left_.subspan(size);
    end_ = end_ && size == core::usb::kControlPacketBytes;  // an empty packet may follow
  }

  void continue_sending() {
    if (stage_ != Stage::kSending || !has(block_.in[0].intr, otg::kDone)) {
      return;
    }
    if (!left_.empty() || end_) {
      send_control_packet();
    } else {
      stage_ = Stage::kNone;
    }
  }

  void receive_control_packet() {
    block_.out[0].tsiz =
        otg::kThreeSetups | (1U << otg::kPacketShift) | core::usb::kControlPacketBytes;
    set(block_.out[0].ctl, otg::kEnable | otg::kClearNak);
  }

  // ---- the receive FIFO, which all OUT endpoints share

  // An endpoint is enabled for one packet at a time, so there is room for each that arrives.
  void receive() {
    for (std::uint32_t i = 0; i < kEntries && has(block_.gintsts, otg::kReceived);
         ++i) {  // bound: kEntries
      const std::uint32_t entry = stm32f4::read(block_.grxstsp);
      const std::uint32_t endpoint = entry & 0xFU;
      const std::uint32_t bytes = (entry >> 4U) & 0x7FFU;
      const std::uint32_t status = (entry >> 17U) & 0xFU;
      if (status == otg::kSetupData) {
        take_setup();
      } else if (status == otg::kSetupEnd) {
        end_setup();
      } else if (status == otg::kOutData) {
        take_data(endpoint, bytes);
      } else if (status == otg::kOutEnd) {
        end_data(endpoint);
      }
    }
  }

  /// Of several SETUP packets the last one counts (USB 2.0, 8.5.3).
  void take_setup() {
    const std::uint32_t words[2] = {stm32f4::read(block_.fifo[0].word),
                                    stm32f4::read(block_.fifo[0].word)};
    __builtin_memcpy(static_cast<void*>(&setup_), words, sizeof setup_);
    setup_state_ = SetupState::kReceived;
    stage_ = Stage::kNone;
  }

  /// No other SETUP packet follows. The core NAKs both directions until they are enabled again.
  void end_setup() {
    block_.out[0].intr = otg::kSetupDone | otg::kDone;
    set(block_.out[0].tsiz, otg::kThreeSetups);
    end_transfer(0);
    if (setup_state_ == SetupState::kReceived) {
      setup_state_ = SetupState::kComplete;
    }
  }

  void take_data(std::uint32_t endpoint, std::uint32_t bytes) {
    std::span<std::byte> to{};
    if (endpoint == kLink) {
      to = link_;
    } else if (endpoint == 0U && stage_ == Stage::kReceiving) {
      to = std::span(control_).subspan(received_, expected_ - received_);
    }
    const std::size_t room = to.size();
    for (std::uint32_t at = 0; at < bytes; at += 4U) {  // bound: 512
      const std::uint32_t word = stm32f4::read(block_.fifo[0].word);
      const std::size_t left = bytes - at < 4U ? bytes - at : 4U;
      const std::size_t size = to.size() < left ? to.size() : left;
      __builtin_memcpy(to.data(), &word, size);
      to = to.subspan(size);
    }
    const std::size_t taken = room - to.size();
    if (endpoint == kLink) {
      link_size_ = taken;
      link_next_ = 0;
    } else {
      received_ += taken;
      is_short_ = bytes < core::usb::kControlPacketBytes;
    }
  }

  void end_data(std::uint32_t endpoint) {
    if (endpoint > kLink) {
      return;  // no OUT endpoint
    }
    block_.out[endpoint].intr = otg::kDone;
    if (endpoint == kLink) {
      receives_link_ = false;
    } else if (stage_ == Stage::kReceiving) {
      if (is_short_ || received_ == expected_) {
        stage_ = Stage::kReceived;
      } else {
        receive_control_packet();
      }
    }
  }

  void receive_link_packet() {
    if (!receives_link_) {
      receives_link_ = true;
      block_.out[kLink].tsiz = (1U << otg::kPacketShift) | core::usb::kBulkPacketBytesFull;
      set(block_.out[kLink].ctl, otg::kEnable | otg::kClearNak);
    }
  }

  OtgFsBlock<Word>& block_;
  bool started_ = false;
  bool in_reset_ = false;
  bool suspended_ = false;
  bool open_ = false;

  // Endpoint 0.
  SetupState setup_state_ = SetupState::kNone;
  Stage stage_ = Stage::kNone;
  core::usb::SetupPacket setup_{};
  std::span<const std::byte> left_{};  // to send
  bool end_ = false;                   // a packet of 64 bytes does not end the data stage
  bool is_short_ = false;              // the last packet received
  std::size_t expected_ = 0;
  std::size_t received_ = 0;
  alignas(4) std::byte control_[core::usb::kDfuTransferBytes] = {};

  // A packet of the link.
  bool receives_link_ = false;
  std::size_t link_size_ = 0;
  std::size_t link_next_ = 0;
  alignas(4) std::byte link_[core::usb::kBulkPacketBytesFull] = {};
};

}  // namespace tactree::firmware::stm32f4
