// A board with an invalid blob boots, reports it, and applies no force. An emulated session that
// cannot continue ends with an error that names the board, the cause and the hint.

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

#include "boards_for_test.hpp"
#include "message_of.hpp"

namespace tactree::test {
namespace {

using emulation::EmulatedTarget;
using emulation::EmulationError;
using Bytes = std::vector<std::byte>;

Bytes good_blob() {
  const std::span<const std::byte> bytes = touched_shape().bytes();
  return {bytes.begin(), bytes.end()};
}

void expect_in(const std::string& words, const std::string& text) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}

class BlobOnBoard : public OnBoard {
 protected:
  /// Boots with these bytes, tries to arm, and returns the status of the blob.
  static core::BlobStatus refusal(const Bytes& blob) {
    return start_without_force(blob, options()).blob;
  }

  static hal::StartResult start_without_force(const Bytes& blob,
                                              const emulation::EmulationOptions& options) {
    hal::sim::SimBoard device({}, {});
    EmulatedTarget target(board(), blob, options);
    const hal::StartResult start = target.start(device, {});
    for (int tick = 0; tick < 300; ++tick) {
      device.sample({0.0, 0.0, -0.001 * tick});
      device.link().post(tick % 50 == 0 ? core::Command::kArm : core::Command::kNone);
      device.safety_inputs().hold_dead_man(tick % 50 > 25);
      const core::Status status = target.tick(device);
      EXPECT_NE(status.state, core::State::kActive);
      EXPECT_EQ(status.force, core::Vec3{});
      EXPECT_EQ(device.effort(0), 0.0);
      EXPECT_FALSE(device.enable_line().read_back());
    }
    target.finish();
    return start;
  }
};
TACTREE_ON_EVERY_BOARD(BlobOnBoard);

TEST_P(BlobOnBoard, IsRefusedIfMissing) {
  EXPECT_EQ(refusal({}), core::BlobStatus::kTooShort);  // the area reads as zeros
  EXPECT_EQ(refusal(Bytes(4096, std::byte{0xFF})), core::BlobStatus::kBadMagic);
}

TEST_P(BlobOnBoard, IsRefusedIfTruncated) {
  Bytes blob = good_blob();
  blob.resize(blob.size() / 2);
  EXPECT_EQ(refusal(blob), core::BlobStatus::kBadChecksum);
}

TEST_P(BlobOnBoard, IsRefusedWithWrongBit) {
  Bytes blob = good_blob();
  blob[blob.size() - 5] ^= std::byte{4};
  EXPECT_EQ(refusal(blob), core::BlobStatus::kBadChecksum);
}

TEST_P(BlobOnBoard, OversizedIsRefusedByBoard) {
  Bytes blob = good_blob();
  const std::uint32_t size = board().blob_bytes_max + 4;
  std::memcpy(blob.data() + offsetof(core::BlobHeader, total_bytes), &size, 4);
  EXPECT_EQ(refusal(blob), core::BlobStatus::kBadSize);
}

TEST_P(BlobOnBoard, OversizedIsRefusedBeforeBoot) {
  const std::size_t size = board().blob_bytes_max + std::size_t{1};
  const std::unique_ptr<std::byte[]> untouched(new std::byte[size]);
  const std::span<const std::byte> blob(untouched.get(), size);
  const std::string error =
      message_of<EmulationError>([&] { EmulatedTarget(board(), blob, options()); });
  expect_in(board().name, error);
  expect_in(std::to_string(blob.size()) + " bytes", error);
  expect_in("--flash-budget " + std::to_string(board().blob_bytes_max), error);
}

TEST_P(BlobOnBoard, IsIgnoredByDamagedProgram) {
  std::ifstream in(built(board(), "firmware", board().name), std::ios::binary);
  std::string image((std::istreambuf_iterator<char>(in)), {});
  const std::size_t identity = image.find(std::string("TACTIMG\0", 8));
  ASSERT_NE(identity, std::string::npos);
  image[identity + 30] ^= 1;  // behind the board's name: unused
  const auto file =
      std::filesystem::path(testing::TempDir()) / (std::string("damaged-") + board().name + ".elf");
  std::ofstream(file, std::ios::binary) << image;
  emulation::EmulationOptions damaged = options();
  damaged.image = file;
  EXPECT_EQ(start_without_force(good_blob(), damaged).image, hal::ImageStatus::kDamaged);
  std::filesystem::remove(file);
}

TEST_P(BlobOnBoard, IsIgnoredOnRamFailure) {
  emulation::EmulationOptions forgetful = options();
  forgetful.image = built(board(), "tests/on_target", std::string("forgetful-") + board().name);
  if (!std::filesystem::exists(forgetful.image)) {
    GTEST_SKIP() << "all of its memory can be written";
  }
  EXPECT_EQ(start_without_force(good_blob(), forgetful).image, hal::ImageStatus::kBadMemory);
}

class Failure : public OnBoard {};
TACTREE_ON_EVERY_BOARD(Failure);

TEST_P(Failure, ReportsFaultingImage) {
  emulation::EmulationOptions faulty = options();
  faulty.image = built(board(), "tests/on_target", std::string("faulty-") + board().name);
  const std::string error = message_of<EmulationError>([&] {
    hal::sim::SimBoard device({}, {});
    EmulatedTarget target(board(), good_blob(), faulty);
    (void)target.start(device, {});
    for (int tick = 0; tick < 100; ++tick) {
      (void)target.tick(device);
    }
  });
  expect_in("restarted unexpectedly: fault", error);
  expect_in("pc 0x", error);
}

TEST_P(Failure, ReportsSilentBoard) {
  emulation::EmulationOptions silent = options();
  silent.image = built(board(), "tests/on_target", std::string("silent-") + board().name);
  silent.start_limit = std::chrono::milliseconds(500);
  const std::string error =
      message_of<EmulationError>([&] { EmulatedTarget(board(), good_blob(), silent); });
  expect_in("no message for 0.5 s", error);
}

TEST_P(Failure, RefusesImageOfAnotherBoard) {
  for (const emulation::BoardDescription& other : emulation::boards()) {
    if (other.toolchain != std::string(board().toolchain) || other.name == board().name) {
      continue;
    }
    emulation::EmulationOptions wrong = options();
    wrong.image = built(other, "firmware", other.name);
    // It may not start on this board.
    wrong.start_limit = std::chrono::milliseconds(2000);
    EXPECT_NE(message_of<EmulationError>([&] { EmulatedTarget(board(), good_blob(), wrong); }), "");
  }
}

TEST_P(Failure, ReportsEarlyEmulatorEnd) {
  emulation::EmulationOptions wrong = options();
  wrong.image = source_folder() / "build/does-not-exist.elf";
  const std::string error =
      message_of<EmulationError>([&] { EmulatedTarget(board(), good_blob(), wrong); });
  expect_in("the emulator terminated unexpectedly", error);
  expect_in("does-not-exist", error);
}

TEST_P(Failure, NamesMissingEmulatorPackage) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nonexistent", 1);
  const std::string error =
      message_of<EmulationError>([&] { EmulatedTarget(board(), good_blob(), options()); });
  ::setenv("PATH", path.c_str(), 1);
  expect_in(std::string("apt-get install ") + board().package, error);
}

TEST_P(Failure, NamesMissingImageBuildCommands) {
  const std::string error =
      message_of<EmulationError>([&] { (void)emulation::find_image(board(), "/nonexistent"); });
  expect_in(std::string(board().name) + ".elf", error);
  expect_in(std::string("cmake --build --preset ") + board().toolchain, error);
}

TEST(Boards, HaveUniqueNames) {
  for (const emulation::BoardDescription& board : emulation::boards()) {
    EXPECT_EQ(emulation::find_board(board.name), &board);
  }
  EXPECT_EQ(emulation::find_board("host"), nullptr);
}

}  // namespace
}  // namespace tactree::test
