// Two slots and a log of records, with power cuts at every operation and at every pair of them.

#include "tactree/store/model_store.hpp"

#include <gtest/gtest.h>
#include <sodium.h>

#include <array>
#include <cstring>

#include "tactree/hal/sim/flash.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

using core::wire::WireStatus;
using hal::sim::SimFlash;
using Store = store::ModelStore<SimFlash>;
using Bytes = std::vector<std::byte>;

/// Three small models of a few sectors each.
const TestBlob& model(int number) {
  static const TestBlob kModels[3] = {TestBlob(sphere(0.02, 0.006)), TestBlob(sphere(0.02, 0.007)),
                                      TestBlob(sphere(0.02, 0.008))};
  return kModels[number];
}

Bytes bytes_of_model(int number) {
  const auto bytes = std::as_bytes(std::span(model(number).written().bytes));
  return {bytes.begin(), bytes.end()};
}

hal::FlashGeometry geometry() {
  // Few records in a sector, so that both sectors are used in turn.
  return {1024, 2 + 2 * 8, 32};
}

struct Key {
  std::array<std::uint8_t, 32> open{};
  std::array<std::uint8_t, 64> secret{};
  Key() {
    const std::array<std::uint8_t, 32> seed{1, 2, 3};
    crypto_sign_seed_keypair(open.data(), secret.data(), seed.data());
  }
};

const Key& key() {
  static const Key kKey;
  return kKey;
}

struct Order {
  Bytes bytes;
  std::string board;
  std::uint32_t counter = 0;
  bool is_signed = false;
};

core::wire::BeginModelRequest announce(const Order& order) {
  core::wire::BeginModelRequest request;
  std::memcpy(request.board, order.board.data(), order.board.size());
  request.counter = order.counter;
  request.bytes = static_cast<std::uint32_t>(order.bytes.size());
  request.checksum = core::crc32(order.bytes);
  return request;
}

core::wire::FinishModelRequest sign(const Order& order) {
  core::wire::FinishModelRequest request;
  if (!order.is_signed) {
    return request;
  }
  core::wire::ModelManifest manifest;
  std::memcpy(manifest.board, order.board.data(), order.board.size());
  manifest.counter = order.counter;
  manifest.bytes = static_cast<std::uint32_t>(order.bytes.size());
  const auto head = std::as_bytes(std::span(&manifest, 1));
  Bytes message(head.begin(), head.end());
  message.insert(message.end(), order.bytes.begin(), order.bytes.end());
  request.is_signed = 1;
  crypto_sign_detached(request.signature, nullptr,
                       reinterpret_cast<const std::uint8_t*>(message.data()), message.size(),
                       key().secret.data());
  return request;
}

constexpr int kOwner = 0;

WireStatus erase_all(Store& store, WireStatus status) {
  while (status == WireStatus::kOk && store.is_erasing()) {
    status = store.erase_next();
  }
  return status;
}

WireStatus write_all(Store& store, const Bytes& bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += core::wire::kMaxPiece) {
    const std::size_t size = std::min<std::size_t>(core::wire::kMaxPiece, bytes.size() - at);
    const WireStatus status =
        store.write(static_cast<std::uint32_t>(at), std::span(bytes).subspan(at, size), &kOwner);
    if (status != WireStatus::kOk) {
      return status;
    }
  }
  return WireStatus::kOk;
}

/// From begin to finish; the slot is in transfer_slot().
WireStatus transfer(Store& store, const Order& order) {
  WireStatus status = erase_all(store, store.begin(announce(order), &kOwner));
  if (status == WireStatus::kOk) {
    status = write_all(store, order.bytes);
  }
  core::BlobStatus blob = core::BlobStatus::kOk;
  return status == WireStatus::kOk ? store.finish(sign(order), blob, &kOwner) : status;
}

WireStatus update(Store& store, const Order& order) {
  const WireStatus status = transfer(store, order);
  return status == WireStatus::kOk ? store.activate(store.transfer_slot()) : status;
}

bool is_model(std::span<const std::byte> bytes, int number) {
  const Bytes wanted = bytes_of_model(number);
  return bytes.size() == wanted.size() &&
         std::memcmp(bytes.data(), wanted.data(), wanted.size()) == 0;
}

Order next_model() { return {bytes_of_model(1), "", 0, false}; }

struct StoreTest : ::testing::Test {
  SimFlash flash{geometry()};
  store::StoreSetup setup{"here", nullptr, {}};
};

TEST_F(StoreTest, FindsNothingInEmptyFlash) {
  Store store(flash, setup);
  EXPECT_TRUE(store.mount());
  EXPECT_TRUE(store.active().empty());
  EXPECT_EQ(store.list().slot[0].state, static_cast<std::uint8_t>(core::wire::SlotState::kEmpty));
}

TEST_F(StoreTest, UsesImageModelUntilUpdate) {
  const Bytes factory = bytes_of_model(2);
  setup.factory = factory;
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  EXPECT_TRUE(is_model(store.active(), 2));
  ASSERT_EQ(update(store, {bytes_of_model(0), "", 0, false}), WireStatus::kOk);
  EXPECT_TRUE(is_model(store.active(), 0));
}

TEST_F(StoreTest, UpdatesAndRollsBack) {
  {
    Store store(flash, setup);
    ASSERT_TRUE(store.mount());
    ASSERT_EQ(update(store, {bytes_of_model(0), "", 0, false}), WireStatus::kOk);
    ASSERT_EQ(update(store, {bytes_of_model(1), "here", 0, false}), WireStatus::kOk);
    EXPECT_TRUE(is_model(store.active(), 1));
  }
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  EXPECT_TRUE(is_model(store.active(), 1));
  ASSERT_EQ(store.activate(store.other_slot()), WireStatus::kOk);
  EXPECT_TRUE(is_model(store.active(), 0));
  EXPECT_EQ(store.begin_erase(store.other_slot(), &kOwner), WireStatus::kOk);
  EXPECT_EQ(erase_all(store, WireStatus::kOk), WireStatus::kOk);
  core::BlobView view;
  core::BlobStatus blob = core::BlobStatus::kOk;
  EXPECT_EQ(store.open(store.other_slot(), view, blob), WireStatus::kNoModel);
  EXPECT_TRUE(is_model(store.active(), 0));
  EXPECT_EQ(flash.mistakes(), 0U);
}

TEST_F(StoreTest, WearsRecordSectorsEvenly) {
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(update(store, {bytes_of_model(i % 3), "", 0, false}), WireStatus::kOk) << i;
    Store again(flash, setup);
    ASSERT_TRUE(again.mount());
    ASSERT_TRUE(is_model(again.active(), i % 3)) << i;
  }
  EXPECT_EQ(flash.mistakes(), 0U);
  EXPECT_NEAR(flash.erased_times(0), flash.erased_times(1), 1);
}

TEST_F(StoreTest, KeepsParameters) {
  float values[core::kParameters] = {};
  values[3] = 0.25F;
  {
    Store store(flash, setup);
    ASSERT_TRUE(store.mount());
    EXPECT_EQ(store.parameters(), nullptr);
    ASSERT_EQ(store.save_parameters(values), WireStatus::kOk);
    ASSERT_EQ(update(store, {bytes_of_model(0), "", 0, false}), WireStatus::kOk);
  }
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  ASSERT_NE(store.parameters(), nullptr);
  EXPECT_EQ(store.parameters()[3], 0.25F);
}

TEST_F(StoreTest, DistinguishesRefusals) {
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  const Order good{bytes_of_model(0), "", 0, false};
  ASSERT_EQ(update(store, good), WireStatus::kOk);
  core::BlobStatus blob = core::BlobStatus::kOk;

  Order bad = good;
  bad.bytes.resize(geometry().sector_bytes * 8U + 4U);
  EXPECT_EQ(transfer(store, bad), WireStatus::kTooLarge);
  bad = good;
  bad.board = "there";
  EXPECT_EQ(transfer(store, bad), WireStatus::kWrongBoard);
  bad = good;
  bad.bytes[100] ^= std::byte{1};
  EXPECT_EQ(transfer(store, bad), WireStatus::kBadModel);
  bad.bytes.resize(16);
  EXPECT_EQ(transfer(store, bad), WireStatus::kBadValue);

  EXPECT_EQ(store.write(0, std::span(good.bytes).first(32), &kOwner), WireStatus::kNoTransfer);
  EXPECT_EQ(store.finish({}, blob, &kOwner), WireStatus::kNoTransfer);

  // Cut off before its end; other bytes than announced; a piece that is lost, or comes twice.
  const auto begin = [&](std::uint32_t checksum_error) {
    core::wire::BeginModelRequest request = announce(good);
    request.checksum ^= checksum_error;
    return erase_all(store, store.begin(request, &kOwner));
  };
  ASSERT_EQ(begin(0), WireStatus::kOk);
  EXPECT_EQ(store.write(0, std::span(good.bytes).first(64), &kOwner), WireStatus::kOk);
  EXPECT_EQ(store.write(0, std::span(good.bytes).first(64), &kOwner), WireStatus::kOutOfOrder);
  EXPECT_EQ(store.write(128, std::span(good.bytes).first(64), &kOwner), WireStatus::kOutOfOrder);
  EXPECT_EQ(store.write(64, std::span(good.bytes).first(63), &kOwner), WireStatus::kOutOfOrder);
  EXPECT_EQ(store.write(64, std::span(good.bytes).first(0), &kOwner), WireStatus::kOutOfOrder);
  EXPECT_EQ(store.list().slot[store.transfer_slot()].state,
            static_cast<std::uint8_t>(core::wire::SlotState::kPartial));
  EXPECT_EQ(store.finish({}, blob, &kOwner), WireStatus::kInterrupted);
  ASSERT_EQ(begin(1), WireStatus::kOk);
  ASSERT_EQ(write_all(store, good.bytes), WireStatus::kOk);
  EXPECT_EQ(store.finish({}, blob, &kOwner), WireStatus::kBadChecksum);

  // Two writers.
  constexpr int kOther = 0;
  ASSERT_EQ(begin(0), WireStatus::kOk);
  EXPECT_EQ(store.begin(announce(good), &kOther), WireStatus::kOtherWriter);
  EXPECT_EQ(store.write(0, std::span(good.bytes).first(64), &kOther), WireStatus::kOtherWriter);
  EXPECT_EQ(store.finish({}, blob, &kOther), WireStatus::kOtherWriter);
  store.release(&kOther);
  EXPECT_EQ(store.write(0, std::span(good.bytes).first(64), &kOwner), WireStatus::kOk);
  store.release(&kOwner);
  EXPECT_EQ(erase_all(store, store.begin(announce(good), &kOther)), WireStatus::kOk);
  store.release(&kOther);

  EXPECT_EQ(store.begin_erase(0, &kOwner), WireStatus::kInUse);
  EXPECT_EQ(store.begin_erase(2, &kOwner), WireStatus::kBadValue);
  EXPECT_TRUE(is_model(store.active(), 0));
  EXPECT_EQ(flash.mistakes(), 0U);
}

TEST_F(StoreTest, RefusesUnsignedAndOlderModels) {
  setup.key = key().open.data();
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  EXPECT_EQ(transfer(store, {bytes_of_model(0), "", 5, false}), WireStatus::kBadSignature);
  ASSERT_EQ(update(store, {bytes_of_model(0), "here", 5, true}), WireStatus::kOk);
  EXPECT_EQ(update(store, {bytes_of_model(1), "", 4, true}), WireStatus::kOldCounter);
  ASSERT_EQ(update(store, {bytes_of_model(1), "", 6, true}), WireStatus::kOk);
  // The one before is older now.
  core::BlobView view;
  core::BlobStatus blob = core::BlobStatus::kOk;
  EXPECT_EQ(store.open(store.other_slot(), view, blob), WireStatus::kOldCounter);

  // Signed for another counter, size or board than announced.
  for (int what = 0; what < 3; ++what) {
    const Order order{bytes_of_model(2), "here", 7, true};
    Order other = order;
    other.counter += what == 0 ? 1U : 0U;
    other.board = what == 1 ? "" : other.board;
    other.bytes.resize(other.bytes.size() - (what == 2 ? 4U : 0U));
    ASSERT_EQ(erase_all(store, store.begin(announce(order), &kOwner)), WireStatus::kOk);
    ASSERT_EQ(write_all(store, order.bytes), WireStatus::kOk);
    EXPECT_EQ(store.finish(sign(other), blob, &kOwner), WireStatus::kBadSignature) << what;
  }
  // At the next start the signature is checked again.
  const Key& right = key();
  std::array<std::uint8_t, 32> wrong = right.open;
  Store again(flash, setup);
  ASSERT_TRUE(again.mount());
  EXPECT_TRUE(is_model(again.active(), 1));
  wrong[3] ^= 1U;
  setup.key = wrong.data();
  Store other_key(flash, setup);
  ASSERT_TRUE(other_key.mount());
  EXPECT_TRUE(other_key.active().empty());
}

// Built without the code that verifies signatures: a key then refuses everything.
TEST_F(StoreTest, RefusesSignedModelsItCannotVerify) {
  using Unable = store::ModelStore<SimFlash, SimFlash, false>;
  setup.key = key().open.data();
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  ASSERT_EQ(update(store, {bytes_of_model(0), "here", 5, true}), WireStatus::kOk);
  Unable with_key(flash, setup);
  ASSERT_TRUE(with_key.mount());
  EXPECT_TRUE(with_key.active().empty());
  setup.key = nullptr;
  Unable without_key(flash, setup);
  ASSERT_TRUE(without_key.mount());
  EXPECT_TRUE(is_model(without_key.active(), 0));
}

TEST_F(StoreTest, RefusesCorruptModelsAndRecords) {
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  ASSERT_EQ(update(store, {bytes_of_model(0), "", 0, false}), WireStatus::kOk);
  const std::size_t slot_begin = 2U * geometry().sector_bytes;
  for (std::size_t at = 0; at < bytes_of_model(0).size(); at += 37U) {
    flash.rot(slot_begin + at, 0x10);
    EXPECT_TRUE(store.active().empty()) << at;
    EXPECT_EQ(store.list().slot[0].state,
              static_cast<std::uint8_t>(core::wire::SlotState::kDamaged));
    flash.rot(slot_begin + at, 0x10);
  }
  ASSERT_EQ(update(store, {bytes_of_model(1), "", 0, false}), WireStatus::kOk);
  flash.rot(3, 1);
  flash.rot(store::kRecordBytes + 3, 1);
  flash.rot(geometry().sector_bytes + 3, 1);
  flash.rot(geometry().sector_bytes + store::kRecordBytes + 3, 1);
  Store damaged(flash, setup);
  EXPECT_FALSE(damaged.mount());
  EXPECT_TRUE(damaged.active().empty());
  // And it can be written again.
  ASSERT_EQ(update(damaged, {bytes_of_model(2), "", 0, false}), WireStatus::kOk);
  Store mended(flash, setup);
  ASSERT_TRUE(mended.mount());
  EXPECT_TRUE(is_model(mended.active(), 2));
}

// ---- the model of the image lies in the slots, and the records in a flash of their own

struct FactoryInSlots : ::testing::Test {
  SimFlash records{{512, 2, 4}};
  SimFlash models{{1024, 2 * 8, 4}};
  store::StoreSetup setup{"here", nullptr, {}};

  /// Puts the model where it lies after the image was programmed.
  void program_factory(const Bytes& model, std::uint32_t sector) {
    ASSERT_TRUE(models.program(sector * 1024U, model));
    setup.factory = models.bytes().subspan(sector * std::size_t{1024}, model.size());
  }
  Store mounted() {
    Store store(models, records, setup);
    EXPECT_TRUE(store.mount());
    return store;
  }
};

TEST_F(FactoryInSlots, UsesWholeFlashForModels) {
  Store store = mounted();
  EXPECT_EQ(store.slot_bytes(), 8U * 1024U);
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(update(store, {bytes_of_model(i % 3), "", 0, false}), WireStatus::kOk);
    Store again = mounted();
    ASSERT_TRUE(is_model(again.active(), i % 3)) << i;
  }
  EXPECT_EQ(records.mistakes() + models.mistakes(), 0U);
  EXPECT_NEAR(records.erased_times(0), records.erased_times(1), 1);
}

TEST_F(FactoryInSlots, OverwritesUnusedFactorySlotOnly) {
  program_factory(bytes_of_model(0), 0);
  Store store = mounted();
  EXPECT_EQ(store.begin_erase(0, &kOwner), WireStatus::kInUse);
  ASSERT_EQ(transfer(store, {bytes_of_model(1), "", 0, false}), WireStatus::kOk);
  EXPECT_EQ(store.transfer_slot(), 1U);
  EXPECT_TRUE(is_model(store.active(), 0));
  ASSERT_EQ(store.activate(1), WireStatus::kOk);
  ASSERT_EQ(update(store, {bytes_of_model(2), "", 0, false}), WireStatus::kOk);
  EXPECT_EQ(store.transfer_slot(), 0U);
  EXPECT_TRUE(is_model(mounted().active(), 2));
  EXPECT_EQ(models.mistakes(), 0U);
}

TEST_F(FactoryInSlots, KeepsFactoryModelAcrossSlots) {
  program_factory(bytes_of_model(0), 8U - 1U);
  ASSERT_GT(bytes_of_model(0).size(), 1024U);
  Store store = mounted();
  EXPECT_EQ(transfer(store, {bytes_of_model(1), "", 0, false}), WireStatus::kInUse);
  EXPECT_TRUE(is_model(mounted().active(), 0));
}

TEST_F(FactoryInSlots, UpdatesDespiteInvalidFactoryData) {
  program_factory(Bytes(4096, std::byte{0x55}), 6);
  Store store = mounted();
  EXPECT_EQ(update(store, {bytes_of_model(1), "", 0, false}), WireStatus::kOk);
  EXPECT_TRUE(is_model(mounted().active(), 1));
}

TEST_F(FactoryInSlots, SurvivesPowerCutDuringUpdate) {
  for (SimFlash* cut : {&records, &models}) {
    for (std::uint64_t operation = 0; operation < 2000U; operation += 1U + operation / 16U) {
      records = SimFlash({512, 2, 4});
      models = SimFlash({1024, 2 * 8, 4});
      program_factory(bytes_of_model(0), 0);
      models.power_on();
      cut->cut_power_at(operation, static_cast<int>(operation % 3U));
      Store store = mounted();
      (void)update(store, next_model());
      records.power_on();
      models.power_on();
      Store again = mounted();
      ASSERT_TRUE(is_model(again.active(), 0) || is_model(again.active(), 1)) << operation;
    }
  }
}

// With any bytes in the flash the store starts, and its active model is valid or empty.
TEST_F(StoreTest, SurvivesRandomFlashContent) {
  std::mt19937 random(9);
  Store store(flash, setup);
  ASSERT_TRUE(store.mount());
  ASSERT_EQ(update(store, {bytes_of_model(0), "", 0, false}), WireStatus::kOk);
  ASSERT_EQ(update(store, {bytes_of_model(1), "", 0, false}), WireStatus::kOk);
  const auto now = flash.bytes();
  const Bytes saved(now.begin(), now.end());
  for (int round = 0; round < 2000; ++round) {
    flash.restore(saved);
    for (std::uint32_t i = 0; i < 1U + random() % 20U; ++i) {
      const std::size_t reach = round % 2 == 0 ? 2U * geometry().sector_bytes : saved.size();
      flash.rot(random() % reach, static_cast<std::uint8_t>(random()));
    }
    Store rotten(flash, setup);
    (void)rotten.mount();
    const auto active = rotten.active();
    core::BlobView view;
    ASSERT_TRUE(active.empty() || core::open_blob(active, view) == core::BlobStatus::kOk);
    (void)rotten.list();
  }
}

/// The flash after one update, and the operations that the next one takes.
struct BeforeUpdate {
  Bytes saved;
  std::uint64_t operations = 0;
};

/// `updates`: models written before; the log of records is in another place with each.
BeforeUpdate prepare(int updates) {
  SimFlash flash(geometry());
  Store store(flash, {"here", nullptr, {}});
  EXPECT_TRUE(store.mount());
  for (int i = 0; i < updates; ++i) {
    const int number = i + 1 == updates ? 0 : 2;
    EXPECT_EQ(update(store, {bytes_of_model(number), "", 0, false}), WireStatus::kOk);
  }
  BeforeUpdate before;
  before.saved.assign(flash.bytes().begin(), flash.bytes().end());
  flash.power_on();
  EXPECT_EQ(update(store, next_model()), WireStatus::kOk);
  before.operations = flash.operations();
  return before;
}

/// Starts after a cut: the old or the new model. A repeated update must then succeed.
void expect_old_or_new(SimFlash& flash, const std::string& what) {
  flash.power_on();
  Store store(flash, {"here", nullptr, {}});
  ASSERT_TRUE(store.mount()) << what;
  const auto active = store.active();
  ASSERT_TRUE(is_model(active, 0) || is_model(active, 1)) << what;
}

void expect_update_works(SimFlash& flash, const std::string& what) {
  Store store(flash, {"here", nullptr, {}});
  ASSERT_TRUE(store.mount()) << what;
  ASSERT_EQ(update(store, {bytes_of_model(2), "", 0, false}), WireStatus::kOk) << what;
  Store again(flash, {"here", nullptr, {}});
  ASSERT_TRUE(again.mount()) << what;
  ASSERT_TRUE(is_model(again.active(), 2)) << what;
  ASSERT_EQ(flash.mistakes(), 0U) << what;
}

TEST(PowerCut, KeepsModelAtEveryOperation) {
  for (int updates = 1; updates <= 5; ++updates) {
    const BeforeUpdate before = prepare(updates);
    ASSERT_GE(before.operations, 40U);
    for (std::uint64_t operation = 0; operation < before.operations; ++operation) {
      for (int done = 0; done <= 2; ++done) {
        const std::string what = std::to_string(updates) + " updates, operation " +
                                 std::to_string(operation) + ", done " + std::to_string(done);
        SimFlash flash(geometry());
        flash.seed(static_cast<std::uint32_t>(operation));
        flash.restore(before.saved);
        flash.cut_power_at(operation, done);
        Store store(flash, {"here", nullptr, {}});
        ASSERT_TRUE(store.mount());
        const WireStatus status = update(store, next_model());
        ASSERT_TRUE(status != WireStatus::kOk || operation + 1U == before.operations) << what;
        ASSERT_NO_FATAL_FAILURE(expect_old_or_new(flash, what));
        ASSERT_NO_FATAL_FAILURE(expect_update_works(flash, what));
      }
    }
  }
}

// A cut, a restart with a second update, and a cut during that update.
TEST(PowerCut, KeepsModelAtOperationPairs) {
  const BeforeUpdate before = prepare(2);
  for (std::uint64_t first = 0; first < before.operations; ++first) {
    for (std::uint64_t second = 0; second < before.operations; ++second) {
      const std::string what =
          "operations " + std::to_string(first) + " and " + std::to_string(second);
      SimFlash flash(geometry());
      flash.seed(static_cast<std::uint32_t>(1000U * first + second));
      flash.restore(before.saved);
      for (const std::uint64_t operation : {first, second}) {
        flash.power_on();
        flash.cut_power_at(operation, static_cast<int>((first + second) % 3U));
        Store store(flash, {"here", nullptr, {}});
        ASSERT_TRUE(store.mount()) << what;
        (void)update(store, next_model());
        ASSERT_NO_FATAL_FAILURE(expect_old_or_new(flash, what));
      }
      ASSERT_EQ(flash.mistakes(), 0U) << what;
    }
  }
}

// The first record: the model of the image or the new one.
TEST(PowerCut, KeepsModelDuringFirstUpdate) {
  const Bytes factory = bytes_of_model(0);
  const store::StoreSetup setup{"here", nullptr, factory};
  for (std::uint64_t operation = 0; operation < 200U; ++operation) {
    SimFlash flash(geometry());
    flash.cut_power_at(operation, static_cast<int>(operation % 3U));
    Store store(flash, setup);
    ASSERT_TRUE(store.mount());
    (void)update(store, next_model());
    flash.power_on();
    Store again(flash, setup);
    ASSERT_TRUE(again.mount()) << operation;
    ASSERT_TRUE(is_model(again.active(), 0) || is_model(again.active(), 1)) << operation;
  }
}

}  // namespace
}  // namespace tactree::test
