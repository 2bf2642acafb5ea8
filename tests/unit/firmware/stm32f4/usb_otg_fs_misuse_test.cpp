// The USB driver on the model of the OTG FS core: buses and hosts that misbehave.

#include <gtest/gtest.h>

#include "usb_otg_rig.hpp"

namespace tactree::test {
namespace {

// A reset of the bus after every number of tokens, while everything is under way.
TEST_F(UsbOtg, SurvivesResetAtAnyToken) {
  connect();
  for (int tokens = 0; tokens < 120; ++tokens) {
    core->reset_disables = tokens >= 60;
    claim_link();
    UsbBytes bytes = counting(400);
    send(bytes);
    host.write(counting(200));
    const bool reads = tokens % 2 == 0;
    reads ? host.submit({kIn, core::usb::kGetDescriptor, 0x0200, 0, 75})
          : host.submit({kClass | kToInterface, 1, 0, 1, 512}, counting(512));
    for (int i = 0; i < tokens % 60; ++i) {
      if (i % 3 == 0) {
        device.poll(now_us);
      }
      (void)host.step();
    }
    ASSERT_NO_FATAL_FAILURE(enumerate()) << tokens;
    EXPECT_EQ(device.model().state(), core::usb::DfuState::kIdle);
    ASSERT_EQ(host.error, "") << tokens;
    (void)host.take_read();
    claim_link();
    UsbBytes hello = counting(70);
    host.write(counting(70));
    UsbBytes here;
    for (int i = 0; i < 20; ++i) {
      send(hello);
      turn();
      const UsbBytes came = receive();
      here.insert(here.end(), came.begin(), came.end());
    }
    ASSERT_EQ(host.take_read(), counting(70)) << tokens;
    ASSERT_EQ(here, counting(70)) << tokens;
  }
}

// At the start the board checks its model first, and during an erase of the flash it does not run.
TEST_F(UsbOtg, AnswersRequestSentBeforeFirstPoll) {
  ASSERT_TRUE(driver.start());
  host.begin_reset();
  host.end_reset();
  host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 64});
  for (int i = 0; i < 100; ++i) {
    (void)host.step();
  }
  while (!done()) {
    turn();
  }
  EXPECT_EQ(host.result(), Result::kDone);
  EXPECT_EQ(host.answer().size(), 18U);
}

TEST_F(UsbOtg, AnswersRequestSentBeforeEndOfResetIsSeen) {
  connect();
  host.begin_reset();
  device.poll(now_us);
  host.end_reset();
  host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 64});
  for (int i = 0; i < 20; ++i) {
    (void)host.step();
  }
  while (!done()) {
    turn();
  }
  EXPECT_EQ(host.result(), Result::kDone);
}

TEST_F(UsbOtg, StartsAnewAfterLongPause) {
  connect();
  for (int pending = 0; pending < 3; ++pending) {
    host.submit({kOut, core::usb::kSetAddress, 99, 0, 0});  // of the time before the reset
    for (int i = 0; i < 4 * pending; ++i) {
      (void)host.step();
    }
    host.begin_reset();
    host.end_reset();
    host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 64});
    while (!done()) {
      (void)host.step();
    }
    ASSERT_EQ(host.result(), Result::kFailed) << "the core has another address";
    reset_bus();
    ASSERT_EQ(get(0x0100, 18), Result::kDone) << pending;
    ASSERT_NO_FATAL_FAILURE(enumerate());
  }
}

TEST_F(UsbOtg, ForgetsRequestSentBeforeReset) {
  connect();
  for (int i = 0; i < 5; ++i) {
    host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 64});
    (void)host.step();  // nothing but the SETUP packet
    reset_bus();
  }
  ASSERT_NO_FATAL_FAILURE(enumerate());
  for (int tokens = 1; tokens < 13; ++tokens) {
    host.submit({kOut, core::usb::kSetAddress, 99, 0, 0});
    for (int i = 0; i < tokens; ++i) {
      (void)host.step();
    }
    reset_bus();
    ASSERT_EQ(get(0x0100, 18), Result::kDone) << tokens;
    ASSERT_NO_FATAL_FAILURE(enumerate());
  }
}

TEST_F(UsbOtg, ClosesLinkDuringReset) {
  connect();
  claim_link();
  host.write(counting(9));
  for (int i = 0; i < 10; ++i) {
    turn();
  }
  host.begin_reset();
  device.poll(now_us);
  EXPECT_EQ(receive(), UsbBytes{});
  UsbBytes bytes = counting(9);
  send(bytes);
  EXPECT_EQ(bytes, counting(9));
  host.end_reset();
  ASSERT_NO_FATAL_FAILURE(enumerate());
}

TEST_F(UsbOtg, AnswersLastOfSeveralSetups) {
  connect();
  for (int setups = 2; setups <= 3; ++setups) {
    for (int i = 0; i < setups; ++i) {
      const std::uint16_t descriptor = i + 1 < setups ? 0x0200U : 0x0100U;
      host.submit({kIn, core::usb::kGetDescriptor, descriptor, 0, 18});
      while (core->waiting_words() < 3U * static_cast<std::uint32_t>(i + 1)) {
        (void)host.step();  // not the device
      }
    }
    while (!done()) {
      turn();
    }
    ASSERT_EQ(host.result(), Result::kDone);
    EXPECT_EQ(host.answer()[1], 1U) << "the answer to an older one";
  }
}

// The host gives a transfer up after any number of tokens and begins another.
TEST_F(UsbOtg, AbandonsTransferForNewSetup) {
  connect();
  const SetupPacket first[] = {{kIn, core::usb::kGetDescriptor, 0x0200, 0, 75},
                               {kClass | kToInterface, 1, 0, 2, 300},
                               {kOut, core::usb::kSetConfiguration, 1, 0, 0},
                               {kIn, 99, 0, 0, 64}};
  for (const SetupPacket& setup : first) {
    for (int tokens = 1; tokens < 24; ++tokens) {
      for (const bool polled : {false, true}) {
        host.submit(setup, counting(setup.to_host() ? 0 : setup.wLength));
        for (int i = 0; i < tokens && !done(); ++i) {
          if (polled || i % 2 == 0) {
            device.poll(now_us);
          }
          (void)host.step();
        }
        ASSERT_EQ(control({kIn | kClass | kToInterface, 5, 0, 1, 1}), Result::kDone);
        ASSERT_EQ(host.answer().size(), 1U);
        ASSERT_EQ(get(0x0100, 18), Result::kDone) << tokens;
        ASSERT_EQ(host.answer()[1], 1U);
        if (dfu_status(2) == 10U) {
          ASSERT_EQ(control({kClass | kToInterface, 4, 0, 2, 0}), Result::kDone);
        }
      }
    }
  }
}

// The device works between a SETUP packet and its end, when it has not seen that the host has read
// the packet before.
TEST_F(UsbOtg, SendsNoMoreOfOlderRequest) {
  connect();
  host.submit({kIn, core::usb::kGetDescriptor, 0x0200, 0, 75});
  while (host.answer().empty()) {
    device.poll(now_us);
    (void)host.step();
  }
  host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 18});
  while (core->waiting_words() == 0U) {
    (void)host.step();
  }
  device.poll(now_us);
  EXPECT_EQ(core->in(host.address, 0).handshake, Handshake::kNak);
  while (!done()) {
    turn();
  }
  ASSERT_EQ(host.result(), Result::kDone);
  EXPECT_EQ(host.answer().size(), 18U);
}

// A SETUP packet that arrives between the answer's decision and its first packet.
TEST_F(UsbOtg, DropsAnswerToSupersededSetup) {
  connect();
  host.submit({kIn, core::usb::kGetDescriptor, 0x0200, 0, 75});
  for (int i = 0; i < 8; ++i) {
    (void)host.step();
  }
  const hal::UsbEvent event = driver.next_event();
  ASSERT_EQ(event.kind, hal::UsbEvent::Kind::kSetup);
  host.submit({kIn, core::usb::kGetDescriptor, 0x0100, 0, 18});
  while (core->waiting_words() == 0U) {
    (void)host.step();
  }
  const auto stale = core::usb::configuration_descriptor(core::usb::Speed::kFull);
  driver.control_send(stale, false);
  while (!done()) {
    turn();
  }
  ASSERT_EQ(host.result(), Result::kDone);
  EXPECT_EQ(host.answer().size(), 18U);
}

TEST_F(UsbOtg, EndsDataOfRequestWithShortPacket) {
  connect();
  ASSERT_NE(control({kClass | kToInterface, 1, 0, 1, 300}, counting(100)), Result::kPending);
  EXPECT_EQ(driver.control_data().size(), 100U);
}

// More bytes than the request announces, and than any request may have.
TEST_F(UsbOtg, BoundsDataOfRequest) {
  connect();
  ASSERT_EQ(control({kClass | kToInterface, 1, 0, 1, 10}, counting(64)), Result::kDone);
  EXPECT_EQ(driver.control_data().size(), 10U);
  EXPECT_EQ(model.written, counting(10));
  EXPECT_EQ(dfu_status(1), 5U);

  host.submit({kClass | kToInterface, 1, 0, 1, 600}, counting(600));
  for (int i = 0; i < 8; ++i) {
    (void)host.step();
  }
  ASSERT_EQ(driver.next_event().kind, hal::UsbEvent::Kind::kSetup);
  driver.control_receive(600);
  for (int i = 0; i < 8; ++i) {
    (void)host.step();
  }
  EXPECT_EQ(host.result(), Result::kStalled);
}

TEST_F(UsbOtg, ClosesLinkWhileSuspended) {
  connect();
  claim_link();
  ASSERT_EQ(control({kClass | kToInterface, 1, 0, 1, 64}, counting(64)), Result::kDone);
  const int aborts = model.aborts;
  core->suspend(true);
  device.poll(now_us);
  EXPECT_FALSE(device.configured());
  EXPECT_GT(model.aborts, aborts);
  UsbBytes bytes = counting(10);
  send(bytes);
  EXPECT_EQ(bytes.size(), 10U);

  // The host wakes the bus and takes the device for configured.
  core->suspend(false);
  device.poll(now_us);
  EXPECT_TRUE(device.configured());
  send(bytes);
  host.write(counting(8));
  for (int i = 0; i < 10; ++i) {
    turn();
  }
  EXPECT_EQ(host.take_read(), counting(10));
  EXPECT_EQ(receive(), counting(8));

  // A suspension between two polls has no effect.
  core->suspend(true);
  core->suspend(false);
  device.poll(now_us);
  EXPECT_TRUE(device.configured());
}

TEST_F(UsbOtg, StartsAnewAfterCableWasUnplugged) {
  connect();
  claim_link();
  core->suspend(true);  // without a host the bus is idle
  for (int i = 0; i < 100; ++i) {
    device.poll(now_us);
  }
  EXPECT_FALSE(device.configured());
  ASSERT_NO_FATAL_FAILURE(enumerate());
  claim_link();
}

// A host that never reads does not hold up the board or the other endpoints.
TEST_F(UsbOtg, RefusesBytesWhileHostDoesNotRead) {
  connect();
  claim_link();
  host.reads = false;
  UsbBytes bytes = counting(5000);
  std::size_t left = bytes.size();
  for (int i = 0; i < 100; ++i) {
    send(bytes);
    turn();
  }
  left -= bytes.size();
  EXPECT_LE(left, 512U);
  ASSERT_EQ(get(0x0100, 18), Result::kDone);
  host.write(counting(30));
  for (int i = 0; i < 10; ++i) {
    turn();
  }
  EXPECT_EQ(receive(), counting(30));
  host.reads = true;
  for (int i = 0; i < 1000; ++i) {
    send(bytes);
    turn();
  }
  EXPECT_EQ(host.take_read(), counting(5000));
}

// The host asks for everything all the time; the work of the board stays bounded.
TEST_F(UsbOtg, BoundsWorkUnderStormOfTokens) {
  connect();
  claim_link();
  tokens_per_turn = 200;
  host.write(counting(100000));
  UsbBytes bytes = counting(100000);
  std::uint64_t most = 0;
  const auto measure = [&](auto work) {
    const std::uint64_t before = core->accesses;
    work();
    most = std::max(most, core->accesses - before);
  };
  for (int i = 0; i < 500; ++i) {
    if (done()) {
      host.submit({kClass | kToInterface, 1, static_cast<std::uint16_t>(i), 2, 512}, counting(512));
    }
    measure([&] { (void)driver.next_event(); });
    measure([&] { device.poll(now_us); });
    measure([&] { send(bytes); });
    measure([&] { (void)receive(); });
    for (int k = 0; k < tokens_per_turn; ++k) {
      (void)host.step();
    }
  }
  EXPECT_GT(host.naks, 10000U);
  EXPECT_LE(most, Driver::kAccessesMax);
  EXPECT_GE(most, Driver::kAccessesMax * 3U / 4U);
}

// A client opens the link again, which drops what was not sent, while the host reads it: after
// every number of accesses of the driver the transfer ends.
TEST_F(UsbOtg, DropsTransferThatEndsMeanwhile) {
  connect();
  for (int accesses = 0; accesses < 60; ++accesses) {
    claim_link();
    UsbBytes old = counting(10);
    send(old);
    ASSERT_TRUE(old.empty());
    int left = accesses;
    core->meanwhile = [&] {
      if (left-- == 0) {
        (void)core->in(host.address, 1);
      }
    };
    driver.configure(true);
    core->meanwhile = nullptr;
    host.open();
    UsbBytes hello = counting(70);
    for (int i = 0; i < 20; ++i) {
      send(hello);
      turn();
    }
    ASSERT_EQ(host.take_read(), counting(70)) << accesses;
    ASSERT_EQ(core->violation, "") << accesses;
  }
}

TEST_F(UsbOtg, IgnoresEndpointsItDoesNotHave) {
  connect();
  for (std::uint32_t n = 2; n < 16; ++n) {
    tokens_per_turn = 1;
    at_each_turn = [&] {
      core->stray_data(n, UsbBytes(n, 0xEE));
      core->stray_end(n);
    };
    ASSERT_EQ(control({kClass | kToInterface, 1, 0, 1, 200}, counting(200)), Result::kDone);
    EXPECT_EQ(model.written, counting(200));
    at_each_turn = [] {};
    EXPECT_EQ(dfu_status(1), 5U);
    ASSERT_EQ(control({kClass | kToInterface, 6, 0, 1, 0}), Result::kDone);  // DFU_ABORT
  }
  EXPECT_EQ(receive(), UsbBytes{});
}

// The host works between any two accesses of the driver.
TEST_F(UsbOtg, CarriesLinkWhileHostWorksBetweenAccesses) {
  connect();
  claim_link();
  core->meanwhile = [&] { (void)host.step(); };
  UsbBytes to_host = counting(20000);
  host.write(counting(20000));
  UsbBytes here, there;
  for (int i = 0; i < 20000 && (here.size() < 20000U || there.size() < 20000U); ++i) {
    if (done()) {
      EXPECT_NE(host.result(), Result::kStalled);
      host.submit({kIn, core::usb::kGetDescriptor, 0x0200, 0, 75});
    }
    device.poll(now_us);
    send(to_host);
    const UsbBytes came = receive();
    here.insert(here.end(), came.begin(), came.end());
    const UsbBytes read = host.take_read();
    there.insert(there.end(), read.begin(), read.end());
  }
  core->meanwhile = nullptr;
  EXPECT_EQ(here, counting(20000));
  EXPECT_EQ(there, counting(20000));
  EXPECT_EQ(host.error, "");
}

}  // namespace
}  // namespace tactree::test
