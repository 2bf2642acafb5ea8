// Every standard request, well-formed and not, in every state of a device.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "fake_usb.hpp"

namespace tactree::usb_test {
namespace {

using namespace core::usb;

constexpr std::uint8_t kIn = 0x80;
constexpr std::uint8_t kOut = 0x00;
constexpr std::uint8_t kInterfaceIn = 0x81;
constexpr std::uint8_t kInterfaceOut = 0x01;
constexpr std::uint8_t kEndpointIn = 0x82;
constexpr std::uint8_t kEndpointOut = 0x02;

std::uint32_t u16(const Bytes& bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8U;
}

std::string text_of(const Bytes& descriptor) {
  std::string text;
  for (std::size_t i = 2; i + 1 < descriptor.size(); i += 2) {
    text += static_cast<char>(descriptor[i]);
  }
  return text;
}

/// Calls `see(type, descriptor)` for each descriptor in a configuration.
template <class See>
void walk(const Bytes& configuration, See see) {
  std::size_t at = 0;
  while (at < configuration.size()) {
    ASSERT_GE(configuration[at], 2);
    ASSERT_LE(at + configuration[at], configuration.size());
    see(configuration[at + 1], configuration.data() + at);
    at += configuration[at];
  }
  EXPECT_EQ(at, configuration.size());
}

TEST(UsbDescriptors, DescribesDeviceIdentity) {
  Bus bus;
  const Reply device = bus.in(kIn, kGetDescriptor, 0x0100, 0, 64);
  ASSERT_TRUE(device);
  ASSERT_EQ(device->size(), 18U);
  EXPECT_EQ((*device)[0], 18);
  EXPECT_EQ((*device)[1], 1);
  EXPECT_EQ(u16(*device, 2), 0x0201U);  // else Windows does not ask for the BOS
  EXPECT_EQ((*device)[7], 64);
  EXPECT_EQ(u16(*device, 8), bus.identity.vendor);
  EXPECT_EQ(u16(*device, 10), bus.identity.product);
  EXPECT_EQ((*device)[17], 1);
}

TEST(UsbDescriptors, SendsAtMostRequestedLength) {
  Bus bus;
  EXPECT_EQ(bus.in(kIn, kGetDescriptor, 0x0100, 0, 8)->size(), 8U);
  EXPECT_EQ(bus.in(kIn, kGetDescriptor, 0x0200, 0, 9)->size(), 9U);
  EXPECT_EQ(bus.in(kIn, kGetDescriptor, 0x0200, 0, 0xFFFF)->size(), kConfigurationBytes);
}

TEST(UsbDescriptors, DescribesConfigurationAtBothSpeeds) {
  for (const bool high : {false, true}) {
    Bus bus;
    bus.happen(hal::UsbEvent::Kind::kReset, high ? Speed::kHigh : Speed::kFull);
    const Reply configuration = bus.in(kIn, kGetDescriptor, 0x0200, 0, 255);
    ASSERT_TRUE(configuration);
    EXPECT_EQ(u16(*configuration, 2), configuration->size());
    int interfaces = 0;
    int endpoints = 0;
    int announced = 0;
    walk(*configuration, [&](std::uint8_t type, const std::uint8_t* descriptor) {
      if (type == 4) {
        EXPECT_EQ(descriptor[2], interfaces++);
        announced += descriptor[4];
        EXPECT_NE(descriptor[8], 0);  // each has a name
      } else if (type == 5) {
        ++endpoints;
        const auto packet = static_cast<std::uint32_t>(descriptor[4] | descriptor[5] << 8U);
        const bool bulk = descriptor[3] == 2;
        EXPECT_EQ(packet, bulk ? (high ? 512U : 64U) : 16U);
      }
    });
    EXPECT_EQ(interfaces, (*configuration)[4]);
    EXPECT_EQ(interfaces, 3);
    EXPECT_EQ(endpoints, announced);
    EXPECT_EQ(endpoints, 3);
  }
}

TEST(UsbDescriptors, DescribesOtherSpeedIfSupported) {
  Bus bus;
  bus.happen(hal::UsbEvent::Kind::kReset, Speed::kHigh);
  const Reply high = bus.in(kIn, kGetDescriptor, 0x0200, 0, 255);
  Reply other = bus.in(kIn, kGetDescriptor, 0x0700, 0, 255);
  bus.happen(hal::UsbEvent::Kind::kReset, Speed::kFull);
  const Reply full = bus.in(kIn, kGetDescriptor, 0x0200, 0, 255);
  EXPECT_EQ((*other)[1], 7);
  (*other)[1] = 2;
  EXPECT_EQ(other, full);
  EXPECT_NE(full, high);
  ASSERT_EQ(bus.in(kIn, kGetDescriptor, 0x0600, 0, 255)->size(), 10U);

  StandardRequests full_speed_only(bus.identity, false);
  EXPECT_EQ(full_speed_only.setup({kIn, kGetDescriptor, 0x0600, 0, 10}).kind,
            ControlResponse::Kind::kStall);
  EXPECT_EQ(full_speed_only.setup({kIn, kGetDescriptor, 0x0700, 0, 10}).kind,
            ControlResponse::Kind::kStall);
}

TEST(UsbDescriptors, ReturnsStrings) {
  Bus bus;
  EXPECT_EQ(*bus.in(kIn, kGetDescriptor, 0x0300, 0, 255), (Bytes{4, 3, 0x09, 0x04}));
  const char* const expected[] = {
      "",     "Tactree", "Haptic controller", "0123456789ABCDEF00C0FFEE",
      "link", "model",   "parameters"};
  for (std::uint16_t i = 1; i < kStrings; ++i) {
    const Reply string =
        bus.in(kIn, kGetDescriptor, static_cast<std::uint16_t>(0x0300 + i), 0x0409, 255);
    ASSERT_TRUE(string);
    EXPECT_EQ((*string)[0], string->size());
    EXPECT_EQ(text_of(*string), expected[i]);
  }
  EXPECT_FALSE(bus.in(kIn, kGetDescriptor, 0x0300 + kStrings, 0x0409, 255));
  EXPECT_FALSE(bus.in(kIn, kGetDescriptor, 0x03EE, 0, 255));
}

TEST(UsbDescriptors, TruncatesLongName) {
  Identity identity;
  identity.name = "a name that is much longer than the thirty-one characters which fit";
  std::array<std::byte, kStringBytesMax + 4> guarded{};
  const auto out = std::span(guarded).first<kStringBytesMax>();
  EXPECT_EQ(string_descriptor(2, identity, out), kStringBytesMax);
  EXPECT_EQ(guarded[kStringBytesMax], std::byte{0});
}

TEST(UsbDescriptors, LinksBosToMicrosoftDescriptors) {
  Bus bus;
  const Reply bos = bus.in(kIn, kGetDescriptor, 0x0F00, 0, 255);
  ASSERT_TRUE(bos);
  EXPECT_EQ(u16(*bos, 2), bos->size());
  const std::size_t platform = 5;
  ASSERT_EQ((*bos)[platform], 28);
  const std::uint32_t total = u16(*bos, platform + 24);
  const std::uint8_t request = (*bos)[platform + 26];
  const Reply set = bus.in(0xC0, request, 0, 7, static_cast<std::uint16_t>(total));
  ASSERT_TRUE(set);
  EXPECT_EQ(set->size(), total);
  EXPECT_EQ(u16(*set, 8), total);
  // Each subset is as long as it says, and holds a compatible ID and a registry property.
  std::size_t at = 10;
  EXPECT_EQ(u16(*set, at + 6), total - at);
  at += 8;
  for (std::uint32_t function = 0; function < 3; ++function) {
    EXPECT_EQ((*set)[at + 4], function);
    const std::size_t end = at + u16(*set, at + 6);
    ASSERT_LE(end, set->size());
    at += u16(*set, at);
    EXPECT_EQ(std::string(set->begin() + static_cast<long>(at) + 4,
                          set->begin() + static_cast<long>(at) + 10),
              "WINUSB");
    at += u16(*set, at);
    at += u16(*set, at);
    EXPECT_EQ(at, end);
  }
  EXPECT_EQ(at, set->size());
}

TEST(UsbDescriptors, RefusesMalformedMicrosoftRequests) {
  Bus bus;
  EXPECT_FALSE(bus.in(0xC0, kMicrosoftRequest, 0, 8, 64));
  EXPECT_FALSE(bus.in(0xC0, kMicrosoftRequest, 1, 7, 64));
  EXPECT_FALSE(bus.in(0xC1, kMicrosoftRequest, 0, 7, 64));
  EXPECT_FALSE(bus.in(0xC0, kMicrosoftRequest + 1, 0, 7, 64));
  EXPECT_FALSE(bus.out(0x40, kMicrosoftRequest, 0, 7));
}

TEST(UsbDescriptors, RefusesUnknownDescriptors) {
  Bus bus;
  for (std::uint32_t type = 0; type < 256; ++type) {
    const bool there = type == 1 || type == 2 || type == 3 || type == 6 || type == 7 || type == 15;
    EXPECT_EQ(
        bus.in(kIn, kGetDescriptor, static_cast<std::uint16_t>(type << 8U), 0, 64).has_value(),
        there)
        << type;
    if (there && type != 3) {
      EXPECT_FALSE(bus.in(kIn, kGetDescriptor, static_cast<std::uint16_t>(type << 8U | 1U), 0, 64))
          << type;
    }
  }
  EXPECT_FALSE(bus.out(kOut, kGetDescriptor, 0x0100, 0));
  EXPECT_FALSE(bus.out(kOut, 7, 0x0100, 0, {1, 2, 3}));  // SET_DESCRIPTOR
}

// The host may use an endpoint directly after the status stage.
TEST(UsbRequests, TakeEffectBeforeStatusStage) {
  Bus bus;
  using Effects = decltype(bus.controller.at_status);
  ASSERT_TRUE(bus.out(kOut, kSetAddress, 42, 0));
  EXPECT_EQ(bus.controller.at_status, Effects(42, false, std::nullopt));
  ASSERT_TRUE(bus.out(kOut, kSetConfiguration, 1, 0));
  EXPECT_EQ(bus.controller.at_status, Effects(42, true, std::nullopt));
  ASSERT_TRUE(bus.out(kOut | kToEndpoint, kSetFeature, kEndpointHalt, kBulkIn));
  EXPECT_EQ(bus.controller.at_status, Effects(42, true, kBulkIn));
  ASSERT_TRUE(bus.out(kOut | kToEndpoint, kClearFeature, kEndpointHalt, kBulkIn));
  EXPECT_EQ(bus.controller.at_status, Effects(42, true, std::nullopt));
}

TEST(UsbRequests, RefusesMalformedAddresses) {
  Bus bus;
  EXPECT_FALSE(bus.out(kOut, kSetAddress, 128, 0));
  EXPECT_FALSE(bus.out(kOut, kSetAddress, 1, 1));
  EXPECT_FALSE(bus.out(kOut, kSetAddress, 1, 0, {0}));
  EXPECT_FALSE(bus.in(kIn, kSetAddress, 1, 0, 0));
  bus.enumerate();
  EXPECT_FALSE(bus.out(kOut, kSetAddress, 6, 0));
  EXPECT_EQ(bus.controller.address, 5);
}

TEST(UsbRequests, OpensAndClosesEndpoints) {
  Bus bus;
  EXPECT_FALSE(bus.out(kOut, kSetConfiguration, 1, 0)) << "no address yet";
  bus.enumerate();
  EXPECT_TRUE(bus.device.configured());
  EXPECT_TRUE(bus.controller.open);
  EXPECT_EQ(*bus.in(kIn, kGetConfiguration, 0, 0, 1), (Bytes{1}));
  EXPECT_FALSE(bus.out(kOut, kSetConfiguration, 2, 0));
  EXPECT_TRUE(bus.device.configured());
  EXPECT_TRUE(bus.out(kOut, kSetConfiguration, 0, 0));
  EXPECT_FALSE(bus.device.configured());
  EXPECT_FALSE(bus.controller.open);
  EXPECT_EQ(*bus.in(kIn, kGetConfiguration, 0, 0, 1), (Bytes{0}));
}

TEST(UsbRequests, ReturnsStatusOfEveryRecipient) {
  Bus bus;
  EXPECT_EQ(*bus.in(kIn, kGetStatus, 0, 0, 2), (Bytes{1, 0}));
  EXPECT_FALSE(bus.in(kInterfaceIn, kGetStatus, 0, 0, 2)) << "not configured";
  EXPECT_EQ(*bus.in(kEndpointIn, kGetStatus, 0, 0, 2), (Bytes{0, 0}));
  EXPECT_FALSE(bus.in(kEndpointIn, kGetStatus, 0, kBulkIn, 2)) << "not configured";
  bus.enumerate();
  for (std::uint16_t interface = 0; interface < 3; ++interface) {
    EXPECT_EQ(*bus.in(kInterfaceIn, kGetStatus, 0, interface, 2), (Bytes{0, 0}));
  }
  EXPECT_FALSE(bus.in(kInterfaceIn, kGetStatus, 0, 3, 2));
  EXPECT_EQ(*bus.in(kEndpointIn, kGetStatus, 0, kBulkIn, 2), (Bytes{0, 0}));
  EXPECT_FALSE(bus.in(kEndpointIn, kGetStatus, 0, 0x83, 2));
  EXPECT_FALSE(bus.in(kIn, kGetStatus, 0, 0, 1));
  EXPECT_FALSE(bus.in(kIn, kGetStatus, 1, 0, 2));
}

TEST(UsbRequests, HaltsEndpointUntilCleared) {
  Bus bus;
  bus.enumerate();
  const std::byte byte{7};
  EXPECT_EQ(bus.device.write(std::span(&byte, 1)), 1U);
  ASSERT_TRUE(bus.out(kEndpointOut, kSetFeature, kEndpointHalt, kBulkIn));
  EXPECT_EQ(bus.controller.halted, kBulkIn);
  EXPECT_EQ(*bus.in(kEndpointIn, kGetStatus, 0, kBulkIn, 2), (Bytes{1, 0}));
  EXPECT_EQ(bus.device.write(std::span(&byte, 1)), 0U);
  ASSERT_TRUE(bus.out(kEndpointOut, kClearFeature, kEndpointHalt, kBulkIn));
  EXPECT_FALSE(bus.controller.halted);
  EXPECT_EQ(bus.device.write(std::span(&byte, 1)), 1U);
  ASSERT_TRUE(bus.out(kEndpointOut, kSetFeature, kEndpointHalt, kBulkOut));
  ASSERT_TRUE(bus.out(kOut, kSetConfiguration, 1, 0));
  EXPECT_EQ(*bus.in(kEndpointIn, kGetStatus, 0, kBulkOut, 2), (Bytes{0, 0}))
      << "a configuration resets its endpoints";
}

TEST(UsbRequests, RefusesUnknownFeatures) {
  Bus bus;
  bus.enumerate();
  EXPECT_FALSE(bus.out(kOut, kSetFeature, 1, 0)) << "remote wake-up";
  EXPECT_FALSE(bus.out(kOut, kSetFeature, 2, 0x0100)) << "test mode";
  EXPECT_FALSE(bus.out(kInterfaceOut, kSetFeature, 0, 0));
  EXPECT_FALSE(bus.out(kEndpointOut, kSetFeature, 1, kBulkIn));
  EXPECT_FALSE(bus.out(kEndpointOut, kSetFeature, kEndpointHalt, 0x85));
  EXPECT_FALSE(bus.out(kEndpointOut, kSetFeature, kEndpointHalt, kBulkIn, {0}));
  EXPECT_FALSE(bus.in(kEndpointIn, 12, 0, kBulkIn, 2)) << "synch frame";
}

TEST(UsbRequests, OffersOneSettingPerInterface) {
  Bus bus;
  EXPECT_FALSE(bus.in(kInterfaceIn, kGetInterface, 0, 0, 1)) << "not configured";
  bus.enumerate();
  for (std::uint16_t interface = 0; interface < 3; ++interface) {
    EXPECT_EQ(*bus.in(kInterfaceIn, kGetInterface, 0, interface, 1), (Bytes{0}));
    EXPECT_TRUE(bus.out(kInterfaceOut, kSetInterface, 0, interface));
    EXPECT_FALSE(bus.out(kInterfaceOut, kSetInterface, 1, interface));
  }
  EXPECT_FALSE(bus.out(kInterfaceOut, kSetInterface, 0, 3));
  EXPECT_EQ(bus.controller.configurations, 2) << "the setting resets the link's endpoints";
}

TEST(UsbDevice, MovesBytesOnlyWhileConfigured) {
  Bus bus;
  bus.controller.incoming = {1, 2, 3};
  std::array<std::byte, 8> bytes{};
  EXPECT_EQ(bus.device.read(bytes), 0U);
  EXPECT_FALSE(bus.device.send_news({}));
  bus.enumerate();
  EXPECT_EQ(bus.device.read(bytes), 3U);
  EXPECT_TRUE(bus.device.send_news({1, 2, 3, 4}));
  EXPECT_EQ(bus.controller.news.size(), sizeof(NewsPacket));
  bus.happen(hal::UsbEvent::Kind::kDisconnected);
  EXPECT_FALSE(bus.device.send_news({}));
  EXPECT_EQ(bus.device.write(bytes), 0U);
}

TEST(UsbDevice, ReturnsToDefaultOnReset) {
  Bus bus;
  bus.enumerate();
  bus.happen(hal::UsbEvent::Kind::kReset);
  EXPECT_FALSE(bus.device.configured());
  EXPECT_EQ(bus.device.standard().address(), 0);
  EXPECT_FALSE(bus.out(kOut, kSetConfiguration, 1, 0));
}

TEST(UsbDevice, AcceptsConfigurationByController) {
  Bus bus;
  bus.happen(hal::UsbEvent::Kind::kConfigured);
  EXPECT_TRUE(bus.device.configured());
  bus.happen(hal::UsbEvent::Kind::kUnconfigured);
  EXPECT_FALSE(bus.device.configured());
}

TEST(UsbDevice, ReplacesUnfinishedRequest) {
  Bus bus;
  bus.controller.events.push_back({hal::UsbEvent::Kind::kSetup, {}, {kOut, kSetAddress, 9, 0, 0}});
  bus.device.poll(0);  // its status stage never comes
  ASSERT_TRUE(bus.in(kIn, kGetDescriptor, 0x0100, 0, 18));
}

TEST(UsbDevice, LimitsEventsPerTick) {
  Bus bus;
  for (int i = 0; i < 100; ++i) {
    bus.controller.events.push_back({hal::UsbEvent::Kind::kSetup, {}, {kIn, kGetStatus, 0, 0, 2}});
  }
  bus.device.poll(0);
  EXPECT_EQ(bus.controller.events.size(), 96U);
}

TEST(UsbDevice, AnswersRandomRequestsWithinLength) {
  std::mt19937 random(1);
  Bus bus;
  int answered = 0;
  for (int i = 0; i < 200000; ++i) {
    SetupPacket setup;
    const auto small = [&](std::uint32_t values) { return random() % values; };
    constexpr std::uint8_t kTypes[] = {0x00, 0x01, 0x02, 0x21, 0x80, 0x81, 0x82, 0xA1, 0xC0};
    setup.bmRequestType = small(8) == 0 ? static_cast<std::uint8_t>(random()) : kTypes[small(9)];
    setup.bRequest = static_cast<std::uint8_t>(small(4) == 0 ? random() : small(14));
    setup.wValue =
        static_cast<std::uint16_t>(small(4) == 0 ? random() : small(3) << (8 * small(2)));
    setup.wIndex = static_cast<std::uint16_t>(small(3) == 0 ? random() : small(4));
    constexpr std::uint16_t kLengths[] = {0, 1, 2, 6, 64};
    setup.wLength = small(4) == 0 ? static_cast<std::uint16_t>(random()) : kLengths[small(5)];
    const Reply reply = bus.control(setup, Bytes(small(2) == 0 ? setup.wLength : small(600)));
    if (reply) {
      ++answered;
      ASSERT_LE(reply->size(), setup.wLength);
    }
    if (small(200) == 0) {
      bus.happen(hal::UsbEvent::Kind::kReset, Speed::kHigh);
      bus.enumerate();
    }
  }
  EXPECT_GT(answered, 300);
}

}  // namespace
}  // namespace tactree::usb_test
