// DFU 1.1: whole transfers, and every request in every state.

#include <gtest/gtest.h>

#include <numeric>

#include "fake_usb.hpp"

namespace tactree::usb_test {
namespace {

using namespace core::usb;

constexpr std::uint8_t kClassOut = 0x21;
constexpr std::uint8_t kClassIn = 0xA1;

struct Status {
  DfuStatus status;
  std::uint32_t wait_ms;
  DfuState state;
};

/// The requests of a DFU host.
class DfuTest : public testing::Test {
 protected:
  void SetUp() override { bus.enumerate(); }

  Reply request(DfuRequest request, std::uint16_t value = 0, const Bytes& data = {}) {
    return bus.out(kClassOut, static_cast<std::uint8_t>(request), value, interface, data);
  }
  Reply ask(DfuRequest request, std::uint16_t value, std::uint16_t length) {
    return bus.in(kClassIn, static_cast<std::uint8_t>(request), value, interface, length);
  }
  Status status() {
    const Reply reply = ask(DfuRequest::kAskStatus, 0, 6);
    if (!reply || reply->size() != 6) {
      ADD_FAILURE() << "no status";
      return {};
    }
    return {static_cast<DfuStatus>((*reply)[0]),
            (*reply)[1] | static_cast<std::uint32_t>((*reply)[2]) << 8U |
                static_cast<std::uint32_t>((*reply)[3]) << 16U,
            static_cast<DfuState>((*reply)[4])};
  }
  DfuState state() const {
    return interface == kModelInterface ? bus.device.model().state()
                                        : bus.device.parameters().state();
  }
  /// Polls the status until the storage is ready.
  Status status_when_done() {
    Status now = status();
    while (now.state == DfuState::kDownloadBusy || now.state == DfuState::kManifest) {
      bus.now_us += 1000 * now.wait_ms;
      now = status();
    }
    return now;
  }
  void download(const Bytes& bytes, std::size_t piece, std::uint16_t first_block = 0) {
    std::uint16_t block = first_block;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      const std::size_t end = std::min(at + piece, bytes.size());
      ASSERT_TRUE(request(
          DfuRequest::kDownload, block++,
          Bytes(bytes.begin() + static_cast<long>(at), bytes.begin() + static_cast<long>(end))));
      ASSERT_EQ(status_when_done().state, DfuState::kDownloadIdle);
    }
    ASSERT_TRUE(request(DfuRequest::kDownload, block));
    ASSERT_EQ(status_when_done().state, DfuState::kIdle);
  }
  Bytes upload(std::uint16_t piece) {
    Bytes all;
    for (std::uint16_t block = 0;; ++block) {
      const Reply reply = ask(DfuRequest::kUpload, block, piece);
      if (!reply) {
        ADD_FAILURE() << "block " << block;
        return all;
      }
      all.insert(all.end(), reply->begin(), reply->end());
      if (reply->size() < piece) {
        return all;
      }
    }
  }
  void bring_to(DfuState wanted) {
    bus.model.busy_per_block = 0;
    if (wanted == DfuState::kUploadIdle) {
      bus.model.stored = Bytes(100);
      ASSERT_TRUE(ask(DfuRequest::kUpload, 0, 64));
    } else if (wanted == DfuState::kError) {
      ASSERT_FALSE(request(DfuRequest::kDetach, 1000));
    } else if (wanted != DfuState::kIdle) {
      ASSERT_TRUE(request(DfuRequest::kDownload, 0, Bytes(16)));
      if (wanted == DfuState::kDownloadBusy) {
        bus.model.busy_left = 1;
        status();
      } else if (wanted != DfuState::kDownloadSync) {
        status();
      }
      if (wanted == DfuState::kManifestSync || wanted == DfuState::kManifest) {
        ASSERT_TRUE(request(DfuRequest::kDownload, 1));
      }
      if (wanted == DfuState::kManifest) {
        bus.model.busy_left = 1;
        status();
      }
    }
    ASSERT_EQ(state(), wanted);
  }

  Bus bus;
  std::uint16_t interface = kModelInterface;
};

Bytes pattern(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

TEST_F(DfuTest, UploadsDownloadedBytes) {
  for (const std::size_t size : {1U, 511U, 512U, 513U, 40000U}) {
    const Bytes bytes = pattern(size);
    download(bytes, kDfuTransferBytes);
    EXPECT_EQ(bus.model.stored, bytes);
    EXPECT_EQ(upload(kDfuTransferBytes), bytes);
    EXPECT_EQ(upload(64), bytes);
  }
}

TEST_F(DfuTest, AcceptsAndWrapsBlockNumbers) {
  download(pattern(100), 10, 1);
  download(pattern(100), 10, 65533);
}

TEST_F(DfuTest, SeparatesInterfaceStorages) {
  download(pattern(1000), 512);
  interface = kParameterInterface;
  download(pattern(30), 512);
  EXPECT_EQ(bus.model.stored.size(), 1000U);
  EXPECT_EQ(bus.parameters.stored.size(), 30U);
}

TEST_F(DfuTest, DelaysHostWhileStorageBusy) {
  bus.model.busy_per_block = 3;
  download(pattern(2000), 512);
  EXPECT_EQ(bus.model.stored, pattern(2000));
  EXPECT_GE(bus.now_us, 3U * 5U * 5000U);
}

TEST_F(DfuTest, RefusesDownloadsWhileBusy) {
  bring_to(DfuState::kDownloadBusy);
  bus.now_us += 1000;
  const Status early = status();
  EXPECT_EQ(early.state, DfuState::kDownloadBusy);
  EXPECT_EQ(early.wait_ms, bus.model.wait_ms);
  EXPECT_FALSE(request(DfuRequest::kDownload, 1, Bytes(16)));
  EXPECT_EQ(state(), DfuState::kError);
}

TEST_F(DfuTest, ReturnsToSyncAfterWaiting) {
  bring_to(DfuState::kDownloadBusy);
  bus.now_us += 5000;
  bus.device.poll(bus.now_us);
  EXPECT_EQ(state(), DfuState::kDownloadSync);
  EXPECT_EQ(status().state, DfuState::kDownloadIdle);
}

/// Figure A.1 and its tables, with what this device can: download, upload, manifestation tolerant.
/// The one exception is the status while the host is to wait.
TEST_F(DfuTest, FollowsStandardStateTable) {
  struct Row {
    DfuState from;
    DfuState after_download;  // 16 bytes
    DfuState after_empty_download;
    DfuState after_upload;  // a full block
    DfuState after_status;
    DfuState after_clear;
    DfuState after_abort;
  };
  constexpr auto E = DfuState::kError;
  constexpr auto I = DfuState::kIdle;
  const Row rows[] = {
      {I, DfuState::kDownloadSync, E, DfuState::kUploadIdle, I, E, I},
      {DfuState::kDownloadSync, E, E, E, DfuState::kDownloadIdle, E, E},
      {DfuState::kDownloadBusy, E, E, E, DfuState::kDownloadBusy, E, E},
      {DfuState::kDownloadIdle, DfuState::kDownloadSync, DfuState::kManifestSync, E,
       DfuState::kDownloadIdle, E, I},
      {DfuState::kManifestSync, E, E, E, I, E, E},
      {DfuState::kManifest, E, E, E, DfuState::kManifest, E, E},
      {DfuState::kUploadIdle, E, E, DfuState::kUploadIdle, DfuState::kUploadIdle, E, I},
      {E, E, E, E, E, I, E},
  };
  for (const Row& row : rows) {
    const auto expect = [&](DfuState after, const char* what, auto&& act) {
      bus.happen(hal::UsbEvent::Kind::kReset, Speed::kHigh);
      bus.enumerate();
      bring_to(row.from);
      bus.model.stored = Bytes(1000);
      const bool accepted = act().has_value();
      EXPECT_EQ(state(), after) << what << " in state " << static_cast<int>(row.from);
      const bool may_be_told = row.from == E && std::string_view(what) == "status";
      EXPECT_EQ(accepted, after != E || may_be_told)
          << what << " in state " << static_cast<int>(row.from);
    };
    const std::uint16_t block = row.from == DfuState::kIdle ? 0 : 1;
    expect(row.after_download, "download",
           [&] { return request(DfuRequest::kDownload, block, Bytes(16)); });
    expect(row.after_empty_download, "empty download",
           [&] { return request(DfuRequest::kDownload, block); });
    expect(row.after_upload, "upload", [&] { return ask(DfuRequest::kUpload, block, 64); });
    expect(row.after_status, "status", [&] { return ask(DfuRequest::kAskStatus, 0, 6); });
    expect(row.after_clear, "clear", [&] { return request(DfuRequest::kClearStatus); });
    expect(row.after_abort, "abort", [&] { return request(DfuRequest::kAbort); });
    expect(E, "detach", [&] { return request(DfuRequest::kDetach, 100); });
    expect(E, "unknown", [&] { return request(static_cast<DfuRequest>(7)); });
  }
}

TEST_F(DfuTest, KeepsStateOnGetState) {
  for (const DfuState wanted : {DfuState::kIdle, DfuState::kDownloadSync, DfuState::kDownloadIdle,
                                DfuState::kManifestSync, DfuState::kUploadIdle, DfuState::kError}) {
    bus.happen(hal::UsbEvent::Kind::kReset, Speed::kHigh);
    bus.enumerate();
    bring_to(wanted);
    EXPECT_EQ(*ask(DfuRequest::kAskState, 0, 1), (Bytes{static_cast<std::uint8_t>(wanted)}));
    EXPECT_EQ(state(), wanted);
  }
}

TEST_F(DfuTest, TreatsMalformedRequestsAsErrors) {
  const auto refused = [&](const SetupPacket& setup, const Bytes& data = {}) {
    EXPECT_FALSE(bus.control(setup, data));
    EXPECT_EQ(status().status, DfuStatus::kStalledPacket);
    EXPECT_TRUE(request(DfuRequest::kClearStatus));
    EXPECT_EQ(state(), DfuState::kIdle);
  };
  refused({kClassIn, 1, 0, interface, 16});                     // a download to the host
  refused({kClassOut, 2, 0, interface, 0});                     // an upload to the device
  refused({kClassIn, 2, 0, interface, 0});                      // of nothing
  refused({kClassIn, 2, 0, interface, kDfuTransferBytes + 1});  // of more than was announced
  refused({kClassOut, 1, 0, interface, kDfuTransferBytes + 1}, Bytes(kDfuTransferBytes + 1));
  refused({kClassIn, 3, 1, interface, 6});
  refused({kClassIn, 3, 0, interface, 5});
  refused({kClassIn, 5, 0, interface, 2});
  refused({kClassOut, 6, 1, interface, 0});
  refused({kClassOut, 6, 0, interface, 1}, Bytes(1));
  refused({kClassOut, 1, 0, interface, 16}, Bytes(15));  // fewer bytes came than announced
}

TEST_F(DfuTest, RefusesOtherRecipientsWithoutError) {
  EXPECT_FALSE(bus.in(kClassIn, 3, 0, kLinkInterface, 6));
  EXPECT_FALSE(bus.in(kClassIn, 3, 0, 3, 6));
  EXPECT_FALSE(bus.in(0xA0, 3, 0, interface, 6));
  EXPECT_FALSE(bus.in(0xA2, 3, 0, interface, 6));
  EXPECT_EQ(state(), DfuState::kIdle);
  bus.happen(hal::UsbEvent::Kind::kReset);
  EXPECT_FALSE(bus.in(kClassIn, 3, 0, interface, 6)) << "not configured";
}

TEST_F(DfuTest, RefusesBlockOutOfOrder) {
  ASSERT_TRUE(request(DfuRequest::kDownload, 0, Bytes(16)));
  status();
  EXPECT_FALSE(request(DfuRequest::kDownload, 2, Bytes(16)));
  EXPECT_EQ(status().status, DfuStatus::kAddress);
  EXPECT_FALSE(bus.model.begun) << "what came before is given up";
}

TEST_F(DfuTest, ReportsStorageStatus) {
  const auto reported = [&] {
    const DfuStatus said = status().status;
    EXPECT_EQ(state(), DfuState::kError);
    EXPECT_TRUE(request(DfuRequest::kClearStatus));
    return said;
  };
  bus.model.at_begin = DfuStatus::kErase;
  EXPECT_FALSE(request(DfuRequest::kDownload, 0, Bytes(16)));
  EXPECT_EQ(reported(), DfuStatus::kErase);
  bus.model.at_begin = DfuStatus::kOk;

  bus.model.capacity = 8;
  EXPECT_FALSE(request(DfuRequest::kDownload, 0, Bytes(16)));
  EXPECT_EQ(reported(), DfuStatus::kAddress);
  bus.model.capacity = 1000;

  ASSERT_TRUE(request(DfuRequest::kDownload, 0, Bytes(16)));
  bus.model.at_progress = DfuStatus::kProgram;
  EXPECT_EQ(reported(), DfuStatus::kProgram);
  bus.model.at_progress = DfuStatus::kOk;

  bring_to(DfuState::kDownloadIdle);
  bus.model.at_finish = DfuStatus::kFile;
  EXPECT_FALSE(request(DfuRequest::kDownload, 1));
  EXPECT_EQ(reported(), DfuStatus::kFile);
  bus.model.at_finish = DfuStatus::kOk;

  bring_to(DfuState::kManifestSync);
  bus.model.at_progress = DfuStatus::kVerify;
  EXPECT_EQ(reported(), DfuStatus::kVerify);
  bus.model.at_progress = DfuStatus::kOk;

  bus.model.at_read = DfuStatus::kFirmware;
  EXPECT_FALSE(ask(DfuRequest::kUpload, 0, 64));
  EXPECT_EQ(reported(), DfuStatus::kFirmware);
}

TEST_F(DfuTest, AbortsTransferOnDisconnect) {
  const Bytes before = pattern(100);
  download(before, 64);
  for (const DfuState wanted : {DfuState::kDownloadSync, DfuState::kDownloadIdle,
                                DfuState::kUploadIdle, DfuState::kError}) {
    bus.model.stored = before;
    bring_to(wanted);
    bus.model.stored = before;
    const int aborts = bus.model.aborts;
    bus.happen(hal::UsbEvent::Kind::kDisconnected);
    EXPECT_GT(bus.model.aborts, aborts);
    EXPECT_EQ(state(), DfuState::kIdle);
    EXPECT_EQ(bus.model.stored, before);
    bus.enumerate();
  }
}

}  // namespace
}  // namespace tactree::usb_test
