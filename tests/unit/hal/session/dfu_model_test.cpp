// A model over DFU into the store of a simulated flash.

#include "tactree/session/dfu_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "tactree/core/link/usb/parameter_storage.hpp"
#include "tactree/hal/sim/flash.hpp"
#include "tactree/store/model_store.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

using core::usb::DfuState;
using core::usb::DfuStatus;
using hal::sim::SimFlash;
using Bytes = std::vector<std::byte>;

struct Platform {
  void hold_ticks(bool) noexcept {}
};
using Store = store::ModelStore<SimFlash>;
using Model = session::DfuModel<Store, Platform>;

Bytes bytes_of_sphere(double spacing_m) {
  static std::vector<std::pair<double, TestBlob>> made;
  for (const auto& [spacing, blob] : made) {
    if (spacing == spacing_m) {
      return blob.written().bytes;
    }
  }
  made.emplace_back(spacing_m, TestBlob(sphere(0.02, spacing_m)));
  return made.back().second.written().bytes;
}

/// A board that was switched on, and a host that downloads.
class DfuRig {
 public:
  explicit DfuRig(SimFlash& flash, std::span<const std::byte> factory = {},
                  const std::uint8_t* key = nullptr, bool may_command = true)
      : store_(flash, {"test", key, factory}) {
    (void)store_.mount();
    core::Configuration configuration;
    configuration.link.may_command = may_command;
    EXPECT_EQ(controller_.configure(configuration), core::ConfigurationStatus::kOk);
  }

  /// The status that the transfer ended with.
  DfuStatus download(std::span<const std::byte> bytes, std::size_t block = 512) {
    std::uint16_t number = 0;
    for (std::size_t at = 0; at < bytes.size(); at += block) {
      const auto piece = bytes.subspan(at, std::min(block, bytes.size() - at));
      if (!send(number++, piece)) {
        return end();
      }
    }
    (void)dfu_.setup({0x21, 1, number, 1, 0});
    return end();
  }

  std::optional<Bytes> upload() {
    Bytes all;
    for (std::uint16_t block = 0;; ++block) {
      const core::usb::ControlResponse answer = dfu_.setup({0xA1, 2, block, 1, 512});
      if (answer.kind != core::usb::ControlResponse::Kind::kSend) {
        return std::nullopt;
      }
      all.insert(all.end(), answer.data.begin(), answer.data.end());
      if (answer.data.size() < 512) {
        return all;
      }
    }
  }

  [[nodiscard]] core::Controller& controller() { return controller_; }
  [[nodiscard]] Store& store() { return store_; }
  [[nodiscard]] session::TickMailbox& mailbox() { return mailbox_; }

 private:
  bool send(std::uint16_t number, std::span<const std::byte> piece) {
    const auto size = static_cast<std::uint16_t>(piece.size());
    return dfu_.setup({0x21, 1, number, 1, size}).kind ==
               core::usb::ControlResponse::Kind::kReceive &&
           dfu_.data(piece).kind == core::usb::ControlResponse::Kind::kAcknowledge &&
           wait() == DfuState::kDownloadIdle;
  }
  DfuState wait() {
    for (int i = 0; i < 1000; ++i) {
      now_us_ += 1000;
      dfu_.advance(now_us_);
      (void)dfu_.setup({0xA1, 3, 0, 1, 6});
      if (dfu_.state() != DfuState::kDownloadBusy) {
        return dfu_.state();
      }
    }
    ADD_FAILURE() << "it does not end";
    return dfu_.state();
  }
  DfuStatus end() {
    (void)wait();
    const DfuStatus status = dfu_.status();
    if (status != DfuStatus::kOk) {
      (void)dfu_.setup({0x21, 4, 0, 1, 0});
    }
    return status;
  }

  Store store_;
  core::Controller controller_;
  session::TickMailbox mailbox_;
  Platform platform_;
  Model model_{store_, controller_, mailbox_, platform_};
  core::usb::Dfu<Model> dfu_{model_};
  std::uint32_t now_us_ = 0;
};

SimFlash make_flash() { return SimFlash({1024, 2 + 2 * 16, 32}); }

TEST(DfuModel, WritesAndReadsBackModel) {
  SimFlash flash = make_flash();
  DfuRig rig(flash);
  EXPECT_EQ(rig.upload(), Bytes());
  for (const double spacing_m : {0.006, 0.005, 0.007}) {
    const Bytes model = bytes_of_sphere(spacing_m);
    ASSERT_EQ(rig.download(model), DfuStatus::kOk);
    EXPECT_EQ(rig.upload(), model);
    EXPECT_TRUE(rig.controller().has_body(0));
    DfuRig after_reset(flash);
    EXPECT_EQ(after_reset.upload(), model);
  }
  EXPECT_EQ(flash.mistakes(), 0U);
}

TEST(DfuModel, ReadsImageModelUntilUpdate) {
  SimFlash flash = make_flash();
  const Bytes factory = bytes_of_sphere(0.006);
  DfuRig rig(flash, factory);
  EXPECT_EQ(rig.upload(), factory);
  ASSERT_EQ(rig.download(bytes_of_sphere(0.005)), DfuStatus::kOk);
  EXPECT_EQ(rig.upload(), bytes_of_sphere(0.005));
}

TEST(DfuModel, RefusesInvalidModelsWithoutEffect) {
  SimFlash flash = make_flash();
  DfuRig rig(flash);
  const Bytes old = bytes_of_sphere(0.006);
  ASSERT_EQ(rig.download(old), DfuStatus::kOk);
  const Bytes model = bytes_of_sphere(0.005);
  for (std::size_t at = 24; at < model.size(); at += 97) {  // not of the length
    Bytes broken = model;
    broken[at] ^= std::byte{4};
    EXPECT_EQ(rig.download(broken), DfuStatus::kFile) << at;
    ASSERT_EQ(rig.upload(), old) << at;
  }
  EXPECT_EQ(rig.download(std::span(model).first(model.size() / 512 * 512)), DfuStatus::kNotDone);
  EXPECT_NE(rig.download(std::span(model).first(model.size() - 4)), DfuStatus::kOk);
  EXPECT_EQ(rig.download(std::span(model).first(100)), DfuStatus::kFile);
  Bytes longer = model;
  longer.resize(model.size() + 32);
  EXPECT_EQ(rig.download(longer), DfuStatus::kAddress);
  EXPECT_EQ(rig.download(bytes_of_sphere(0.001)), DfuStatus::kAddress) << "larger than the slot";
  EXPECT_EQ(rig.upload(), old);
  EXPECT_TRUE(rig.controller().has_body(0));
  EXPECT_EQ(rig.download(model), DfuStatus::kOk) << "a refusal does not last";
}

TEST(DfuModel, RefusesWritesWithoutRequiredSignature) {
  SimFlash flash = make_flash();
  const std::array<std::uint8_t, 32> key{1};
  DfuRig rig(flash, {}, key.data());
  const std::uint64_t before = flash.operations();
  EXPECT_EQ(rig.download(bytes_of_sphere(0.006)), DfuStatus::kTarget);
  EXPECT_EQ(flash.operations(), before);
}

TEST(DfuModel, RefusesWritesOverLinkThatMayOnlyWatch) {
  SimFlash flash = make_flash();
  const Bytes factory = bytes_of_sphere(0.006);
  DfuRig rig(flash, factory, nullptr, false);
  const std::uint64_t before = flash.operations();
  EXPECT_EQ(rig.download(bytes_of_sphere(0.005)), DfuStatus::kTarget);
  EXPECT_EQ(flash.operations(), before);
  EXPECT_EQ(rig.upload(), factory) << "it may read";
}

// Also without begin(), which the states of DFU call first.
void expect_parameter_download(bool may_command, DfuStatus expected) {
  core::Controller controller;
  core::Configuration configuration;
  configuration.link.may_command = may_command;
  ASSERT_EQ(controller.configure(configuration), core::ConfigurationStatus::kOk);
  Platform platform;
  core::usb::ParameterStorage<Platform> storage(controller, platform);
  core::usb::ParameterFile file;
  const auto bytes = std::as_writable_bytes(std::span(&file, 1));
  std::size_t count = 0;
  EXPECT_EQ(storage.read(0, bytes, count), DfuStatus::kOk);
  EXPECT_EQ(count, sizeof file);
  file.values[0] = 7.0F;
  file.checksum = core::usb::checksum_of(file);
  EXPECT_EQ(storage.begin(), expected);
  EXPECT_EQ(storage.write(0, bytes), DfuStatus::kOk);
  EXPECT_EQ(storage.finish(), expected);
  EXPECT_EQ(core::parameter_of(controller.configuration(), 0),
            expected == DfuStatus::kOk ? 7.0F : 0.0F);
}

TEST(DfuParameters, AreRefusedOverLinkThatMayOnlyWatch) {
  expect_parameter_download(true, DfuStatus::kOk);
  expect_parameter_download(false, DfuStatus::kTarget);
}

TEST(DfuModel, LeavesOtherWriterUndisturbed) {
  SimFlash flash = make_flash();
  DfuRig rig(flash);
  core::wire::BeginModelRequest request;
  request.bytes = 2000;
  int somebody = 0;
  ASSERT_EQ(rig.store().begin(request, &somebody), core::wire::WireStatus::kOk);
  EXPECT_EQ(rig.download(bytes_of_sphere(0.006)), DfuStatus::kTarget);
  while (rig.store().is_erasing()) {
    ASSERT_EQ(rig.store().erase_next(), core::wire::WireStatus::kOk);
  }
  const Bytes piece(256);
  EXPECT_EQ(rig.store().write(0, piece, &somebody), core::wire::WireStatus::kOk);
}

/// Whatever was done of it: after the next start there is the old model or the new one.
TEST(DfuModel, SurvivesEveryPowerCut) {
  const Bytes old = bytes_of_sphere(0.006);
  const Bytes fresh = bytes_of_sphere(0.005);
  std::uint64_t operations = 0;
  {
    SimFlash flash = make_flash();
    DfuRig rig(flash);
    ASSERT_EQ(rig.download(old), DfuStatus::kOk);
    const std::uint64_t before = flash.operations();
    ASSERT_EQ(rig.download(fresh), DfuStatus::kOk);
    operations = flash.operations() - before;
  }
  ASSERT_GT(operations, 20U);
  int kept = 0;
  for (std::uint64_t cut = 0; cut < operations; ++cut) {
    for (const int done : {0, 1, 2}) {
      SimFlash flash = make_flash();
      {
        DfuRig rig(flash);
        ASSERT_EQ(rig.download(old), DfuStatus::kOk);
        flash.power_on();
        flash.cut_power_at(cut, done);
        (void)rig.download(fresh);
      }
      flash.power_on();
      DfuRig after(flash);
      const auto model = after.upload();
      ASSERT_TRUE(model == old || model == fresh) << "cut at " << cut << ", " << done;
      kept += model == old ? 1 : 0;
    }
  }
  EXPECT_GT(kept, 0);
}

}  // namespace
}  // namespace tactree::test
