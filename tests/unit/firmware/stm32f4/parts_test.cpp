// Each driver of the chip on a model of its part.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "fake_parts.hpp"
#include "open_gate.hpp"
#include "stm32f4/lines.hpp"
#include "stm32f4/pwm_motors.hpp"
#include "stm32f4/quadrature_encoders.hpp"
#include "stm32f4/serial_port.hpp"
#include "stm32f4/watchdog.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::test {
namespace {

using namespace firmware::stm32f4;

// ---- pins

TEST(Pin, ChangesNoOtherPin) {
  FakeGpio port;
  port.block.moder.value = 0xFFFFFFFF;
  port.block.pupdr.value = 0xFFFFFFFF;
  port.block.afrh.value = 0xFFFFFFFF;
  Pin<FakeWord> pin(port.block, 9);
  pin.make_alternate(7, Pull::kUp);
  EXPECT_EQ(port.block.moder.value, 0xFFFBFFFFU);
  EXPECT_EQ(port.block.pupdr.value, 0xFFF7FFFFU);
  EXPECT_EQ(port.block.afrh.value, 0xFFFFFF7FU);
  EXPECT_EQ(port.block.afrl.value, 0U);
  EXPECT_EQ(port.function(9), 7U);
}

TEST(Pin, StartsOutputLow) {
  FakeGpio port;
  port.block.odr.value = 1U << 4;
  std::vector<bool> levels;
  port.block.moder.on_write = [&](std::uint32_t, std::uint32_t written) {
    levels.push_back((port.block.odr.value & (1U << 4)) != 0U);
    return written;
  };
  Pin<FakeWord> pin(port.block, 4);
  pin.make_output();
  EXPECT_EQ(levels, std::vector<bool>{false});
  pin.drive(true);
  EXPECT_TRUE(pin.is_high());
  pin.drive(false);
  EXPECT_FALSE(pin.is_high());
}

// ---- encoders

struct EncoderBench {
  FakeTimer x{0xFFFFFFFF}, y{0xFFFFFFFF}, z{0xFFFF};
  QuadratureEncoders<FakeWord> bank{
      {x.block, CounterWidth::k32}, {y.block, CounterWidth::k32}, {z.block, CounterWidth::k16}};
};

TEST(Encoders, CountsInBothDirections) {
  EncoderBench bench;
  ASSERT_TRUE(bench.bank.start());
  bench.x.turn(1000);
  bench.y.turn(-7);
  bench.z.turn(-30000);
  const core::EncoderReading reading = bench.bank.read();
  EXPECT_EQ(reading.counts[0], 1000);
  EXPECT_EQ(reading.counts[1], -7);
  EXPECT_EQ(reading.counts[2], -30000);
  EXPECT_TRUE(reading.valid[0] && reading.valid[1] && reading.valid[2]);
  EXPECT_FALSE(reading.index[0] || reading.index[1] || reading.index[2]);
}

TEST(Encoders, ExtendsSixteenBitCounters) {
  EncoderBench bench;
  ASSERT_TRUE(bench.bank.start());
  for (std::int32_t i = 1; i <= 10; ++i) {
    bench.z.turn(32767);
    EXPECT_EQ(bench.bank.read().counts[2], i * 32767);
  }
  for (std::int32_t i = 1; i <= 20; ++i) {
    bench.z.turn(-32768);
    EXPECT_EQ(bench.bank.read().counts[2], 327670 - i * 32768);
  }
}

TEST(Encoders, WrapsAtThirtyTwoBits) {
  EncoderBench bench;
  ASSERT_TRUE(bench.bank.start());
  bench.x.turn(std::numeric_limits<std::int32_t>::max());
  (void)bench.bank.read();
  bench.x.turn(1);
  EXPECT_EQ(bench.bank.read().counts[0], std::numeric_limits<std::int32_t>::min());
}

TEST(Encoders, InvalidatesAxisOfStoppedTimer) {
  EncoderBench bench;
  ASSERT_TRUE(bench.bank.start());
  bench.y.block.cr1.value = 0;
  bench.z.block.smcr.value = 1;
  const core::EncoderReading reading = bench.bank.read();
  EXPECT_TRUE(reading.valid[0]);
  EXPECT_FALSE(reading.valid[1]);
  EXPECT_FALSE(reading.valid[2]);
}

TEST(Encoders, RefusesStartWithoutClock) {
  EncoderBench bench;
  bench.y.gate_by([] { return false; });
  EXPECT_FALSE(bench.bank.start());
  EXPECT_FALSE(bench.bank.read().valid[1]);
}

// ---- motors

struct MotorBench {
  FakeTimer timer{0xFFFF};
  FakeGpio port;
  PwmMotors<FakeWord> motors{timer.block,
                             {{port.block, 0}, {port.block, 1}, {port.block, 2}},
                             Pin<FakeWord>(port.block, 14),
                             {4.0F, 4.0F, 2.0F}};
  MotorBench() {
    for (std::uint32_t pin = 0; pin < 3; ++pin) {
      Pin<FakeWord>(port.block, pin).make_output();
    }
    port.wire(14, true);
  }
};

TEST(Motors, OutputsPulseWidthAndDirection) {
  MotorBench bench;
  ASSERT_TRUE(bench.motors.start());
  bench.motors.connect(true);
  bench.motors.write(command_of({1.0F, -2.0F, 0.5F}));
  EXPECT_EQ(bench.timer.duty(0), 0.0) << "a width took effect within a period";
  bench.timer.take_over();
  EXPECT_NEAR(bench.timer.duty(0), 0.25, 1e-4);
  EXPECT_NEAR(bench.timer.duty(1), 0.5, 1e-4);
  EXPECT_NEAR(bench.timer.duty(2), 0.25, 1e-4);
  EXPECT_FALSE(bench.port.level(0));
  EXPECT_TRUE(bench.port.level(1));
  EXPECT_FALSE(bench.port.level(2));
  EXPECT_TRUE(bench.motors.healthy());
}

TEST(Motors, SwitchesAtTwentyKilohertz) {
  MotorBench bench;
  ASSERT_TRUE(bench.motors.start());
  EXPECT_EQ(firmware::stm32f4::pwm::kHalfPeriod * 2U * 20000U, 168000000U);
  EXPECT_EQ(bench.timer.block.arr.value, firmware::stm32f4::pwm::kHalfPeriod);
  EXPECT_EQ((bench.timer.block.cr1.value >> 5) & 3U, 1U);
}

TEST(Motors, OutputsNothingUntilConnected) {
  MotorBench bench;
  bench.motors.connect(true);  // not started
  bench.motors.write(command_of({4.0F, 4.0F, 2.0F}));
  EXPECT_EQ(bench.timer.block.bdtr.value & (1U << 15), 0U);
  ASSERT_TRUE(bench.motors.start());
  bench.motors.write(command_of({4.0F, 4.0F, 2.0F}));
  bench.timer.take_over();
  EXPECT_EQ(bench.timer.duty(0), 0.0);
  EXPECT_FALSE(bench.timer.floats());
  bench.motors.connect(true);
  EXPECT_EQ(bench.timer.duty(0), 1.0);
  bench.motors.connect(false);
  EXPECT_EQ(bench.timer.duty(0), 0.0);
}

TEST(Motors, ClampsNonFiniteEfforts) {
  using firmware::stm32f4::pwm::compare_of;
  using firmware::stm32f4::pwm::kHalfPeriod;
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(compare_of(std::nanf(""), 1.0F), 0U);
  EXPECT_EQ(compare_of(0.0F, 1.0F), 0U);
  EXPECT_EQ(compare_of(-0.0F, 1.0F), 0U);
  EXPECT_EQ(compare_of(0.5F, 1.0F), kHalfPeriod / 2U);
  EXPECT_EQ(compare_of(-0.5F, 1.0F), kHalfPeriod / 2U);
  EXPECT_EQ(compare_of(1e30F, 1.0F), kHalfPeriod);
  EXPECT_EQ(compare_of(infinity, 1.0F), kHalfPeriod);
}

TEST(Motors, ReportsFailure) {
  MotorBench amplifier;
  ASSERT_TRUE(amplifier.motors.start());
  EXPECT_TRUE(amplifier.motors.healthy());
  amplifier.port.wire(14, false);
  EXPECT_FALSE(amplifier.motors.healthy());

  MotorBench lost;  // a register that does not keep its value
  ASSERT_TRUE(lost.motors.start());
  lost.motors.write(command_of({1.0F, 1.0F, 1.0F}));
  lost.timer.block.ccr2.value ^= 4U;
  EXPECT_FALSE(lost.motors.healthy());

  MotorBench tripped;  // outputs that went off by themselves
  ASSERT_TRUE(tripped.motors.start());
  tripped.motors.connect(true);
  EXPECT_TRUE(tripped.motors.healthy());
  tripped.timer.block.bdtr.value &= ~(1U << 15);
  EXPECT_FALSE(tripped.motors.healthy());

  MotorBench unclocked;
  unclocked.timer.gate_by([] { return false; });
  EXPECT_FALSE(unclocked.motors.start());
  EXPECT_FALSE(unclocked.motors.healthy());
}

// ---- enable line and switches

TEST(EnableLine, StartsOffAndSwitchesPulses) {
  MotorBench bench;
  ASSERT_TRUE(bench.motors.start());
  EnableLine<FakeWord> line({bench.port.block, 4}, {bench.port.block, 5}, bench.motors);
  bench.port.block.odr.value = 1U << 4;
  ASSERT_TRUE(line.start());
  EXPECT_FALSE(bench.port.level(4));
  EXPECT_FALSE(line.read_back()) << "an open sense wire reads as power";
  line.set(true);
  EXPECT_TRUE(bench.port.level(4));
  EXPECT_NE(bench.timer.block.bdtr.value & (1U << 15), 0U);
  EXPECT_FALSE(line.read_back()) << "returns the level set, not the level measured";
  bench.port.wire(5, true);
  EXPECT_TRUE(line.read_back());
  line.set(false);
  EXPECT_FALSE(bench.port.level(4));
  EXPECT_EQ(bench.timer.block.bdtr.value & (1U << 15), 0U);
}

TEST(EnableLine, RefusesStartWithoutClock) {
  MotorBench bench;
  bench.port.gate_by([] { return false; });
  EnableLine<FakeWord> line({bench.port.block, 4}, {bench.port.block, 5}, bench.motors);
  EXPECT_FALSE(line.start());
  EXPECT_FALSE(line.read_back());
}

TEST(SafetyInputs, ReadsBrokenWireAsSafe) {
  FakeGpio port;
  SafetyInputs<FakeWord> inputs({port.block, 12}, {port.block, 13});
  EXPECT_TRUE(inputs.emergency_stop()) << "before the start";
  ASSERT_TRUE(inputs.start());
  EXPECT_TRUE(inputs.emergency_stop());
  EXPECT_FALSE(inputs.dead_man());
  port.wire(12, false);
  port.wire(13, false);
  EXPECT_FALSE(inputs.emergency_stop());
  EXPECT_TRUE(inputs.dead_man());
}

TEST(SafetyInputs, ReadsUnclockedPortAsSafe) {
  FakeGpio port;
  port.wire(12, false);
  port.wire(13, false);
  port.gate_by([] { return false; });
  SafetyInputs<FakeWord> inputs({port.block, 12}, {port.block, 13});
  EXPECT_FALSE(inputs.start());
  EXPECT_TRUE(inputs.emergency_stop());
  EXPECT_FALSE(inputs.dead_man());
}

// ---- serial port

struct SerialBench {
  Ring ring{};
  FakeSerial fake{&ring};
  SerialPort<FakeWord> port{fake.usart, fake.dma, ring};
  bool started = port.start(84000000, 1000000);

  std::optional<std::byte> take() {
    std::byte byte{};
    return port.read(std::span(&byte, 1)) == 1U ? std::optional(byte) : std::nullopt;
  }
  /// Looks at the port as often as a session does, until so many bytes came out.
  void run_until_sent(std::size_t bytes) {
    for (int i = 0; i < 10000 && fake.sent.size() < bytes; ++i) {
      (void)port.read({});
      fake.tick_us(10);
    }
  }
};

static_assert(hal::BytePort<SerialPort<FakeWord>>);

TEST(SerialPort, SetsExactBaudRate) {
  SerialBench bench;
  EXPECT_EQ(bench.fake.baud(), 1e6);
  bench.fake.clock_MHz = 16.0;
  EXPECT_TRUE(bench.port.start(16000000, 1000000));
  EXPECT_EQ(bench.fake.baud(), 1e6);
}

TEST(SerialPort, ReceivesAcrossRingEnd) {
  SerialBench bench;
  ASSERT_TRUE(bench.started);
  EXPECT_FALSE(bench.take().has_value());
  for (std::uint32_t i = 0; i < 3 * kRingBytes; ++i) {
    bench.fake.arrive(static_cast<std::uint8_t>(i));
    ASSERT_EQ(bench.take(), static_cast<std::byte>(i));
    EXPECT_FALSE(bench.take().has_value());
  }
}

TEST(SerialPort, ReadsAtMostAvailableBytes) {
  SerialBench bench;
  for (std::uint32_t i = 0; i < kRingBytes - 1U; ++i) {
    bench.fake.arrive(static_cast<std::uint8_t>(i));
  }
  std::vector<std::byte> bytes(kRingBytes);
  EXPECT_EQ(bench.port.read(std::span(bytes).first(100)), 100U);
  EXPECT_EQ(bench.port.read(bytes), kRingBytes - 101U);
  EXPECT_EQ(bytes[0], std::byte{100});
}

TEST(SerialPort, RestartsDuringRunningStream) {
  SerialBench bench;
  bench.fake.arrive(1);
  ASSERT_TRUE(bench.port.start(84000000, 1000000));
  EXPECT_EQ(bench.fake.dma.stream[2].ndtr.value, kRingBytes);
  EXPECT_FALSE(bench.take().has_value());
  bench.fake.arrive(2);
  ASSERT_EQ(bench.take(), std::byte{2});
}

TEST(SerialPort, ReceivesSingleBytesWithoutDma) {
  SerialBench bench;
  bench.fake.gate_by([] { return true; }, [] { return false; });
  ASSERT_FALSE(bench.port.start(84000000, 1000000));
  EXPECT_FALSE(bench.take().has_value());
  bench.fake.arrive(7);
  bench.fake.arrive(8);  // not polled: lost
  EXPECT_EQ(bench.take(), std::byte{7});
  EXPECT_FALSE(bench.take().has_value());
}

TEST(SerialPort, NeverOverwritesPendingByte) {
  SerialBench bench;
  const std::vector<std::byte> bytes(40, std::byte{0x5A});
  EXPECT_EQ(bench.port.write(bytes), bytes.size());
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(bench.port.write(bytes), 0U);  // the wire stands still
  }
  EXPECT_EQ(bench.fake.violation, "");
  bench.run_until_sent(bytes.size());
  EXPECT_EQ(bench.fake.sent.size(), bytes.size());
  EXPECT_EQ(bench.port.write(bytes), bytes.size());
}

TEST(SerialPort, SendsLongDataInPieces) {
  SerialBench bench;
  std::vector<std::byte> bytes(1000);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(i % 251);
  }
  std::size_t taken = 0;
  for (int i = 0; i < 10000 && taken < bytes.size(); ++i) {
    taken += bench.port.write(std::span(std::as_const(bytes)).subspan(taken));
    bench.fake.tick_us(10);
  }
  bench.run_until_sent(bytes.size());
  ASSERT_EQ(bench.fake.sent.size(), bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    ASSERT_EQ(std::byte{bench.fake.sent[i]}, bytes[i]) << i;
  }
}

// ---- watchdog

TEST(Watchdog, ResetsWithinTenMilliseconds) {
  for (const double oscillator_hz : {17000.0, 32000.0, 47000.0}) {
    FakeWatchdog fake;
    fake.oscillator_hz = oscillator_hz;
    Watchdog<FakeWord> watchdog(fake.block);
    ASSERT_TRUE(watchdog.start());
    for (int i = 0; i < 100; ++i) {
      watchdog.refresh();
      fake.tick_us(3000);
      ASSERT_FALSE(fake.bitten()) << oscillator_hz;
    }
    fake.tick_us(7000);  // the loop stopped 10 ms ago
    EXPECT_TRUE(fake.bitten()) << oscillator_hz;
  }
}

TEST(Watchdog, ExtendsAndRestoresTimeout) {
  for (const double oscillator_hz : {17000.0, 32000.0, 47000.0}) {
    FakeWatchdog fake;
    fake.oscillator_hz = oscillator_hz;
    Watchdog<FakeWord> watchdog(fake.block);
    ASSERT_TRUE(watchdog.start());
    fake.tick_us(2500);
    ASSERT_TRUE(watchdog.set(kTimeOfErasing));
    fake.tick_us(2.9e6);
    ASSERT_FALSE(fake.bitten()) << oscillator_hz;
    ASSERT_TRUE(watchdog.set(kTimeOfTicks));
    fake.tick_us(3000);
    ASSERT_FALSE(fake.bitten()) << oscillator_hz;
    fake.tick_us(6000);
    EXPECT_TRUE(fake.bitten()) << oscillator_hz;
  }
}

TEST(Watchdog, WaitsForPendingSetting) {
  FakeWatchdog fake;
  Watchdog<FakeWord> watchdog(fake.block);
  ASSERT_TRUE(watchdog.start());
  fake.block.kr = 0x5555U;
  fake.block.rlr = 99U;  // a pending update of another writer
  EXPECT_TRUE(watchdog.set(kTimeOfErasing));
  EXPECT_EQ(fake.block.rlr.value, kTimeOfErasing.reload);
}

TEST(Watchdog, StaysOffBeforeStart) {
  FakeWatchdog fake;
  Watchdog<FakeWord> watchdog(fake.block);
  watchdog.refresh();
  EXPECT_FALSE(fake.runs());
}

TEST(Watchdog, ReportsRejectedSettings) {
  FakeWatchdog deaf;
  deaf.takes_settings = false;
  EXPECT_FALSE(Watchdog<FakeWord>(deaf.block).start());
  FakeWatchdog half;
  half.takes_prescaler = false;
  EXPECT_FALSE(Watchdog<FakeWord>(half.block).set(kTimeOfErasing));
  FakeWatchdog slow;
  slow.update_polls = watchdog::kPolls + 2U;
  EXPECT_FALSE(Watchdog<FakeWord>(slow.block).start());
}

}  // namespace
}  // namespace tactree::test
