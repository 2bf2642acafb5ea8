// How many float operations a tick takes: in ordinary contact, and at most.

#include <cstring>
#include <random>

#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::test {
namespace {

using core::Vec3;

class Operations : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream file(TACTREE_BLOB, std::ios::binary);
    const std::vector<char> read((std::istreambuf_iterator<char>(file)), {});
    words_.resize((read.size() + 3U) / 4U);
    const auto bytes = std::as_writable_bytes(std::span(words_)).first(read.size());
    std::memcpy(bytes.data(), read.data(), read.size());
    ASSERT_EQ(core::open_blob(bytes, view_), core::BlobStatus::kOk);
  }

  /// Of one tick of the whole scene, all bodies and materials considered.
  std::uint64_t tick(Vec3 probe, Vec3 velocity) {
    const std::uint64_t before = operations;
    last_ = scene_.update(configuration_, probe, velocity);
    return operations - before;
  }

  /// Of one tick of any body, from the loops of core:
  ///   gather    per point kept its position and normal; per leaf where the centre is
  ///   pass      per candidate: weight, face, sums; then a sphere, or at a crease three for two
  [[nodiscard]] std::uint64_t most() const {
    constexpr std::uint64_t kPosition = 18;
    constexpr std::uint64_t kNormal = 24;
    constexpr std::uint64_t kLeaves = 400;
    constexpr std::uint64_t kCandidate = 45;
    constexpr std::uint64_t kSphere = 90;
    constexpr std::uint64_t kNearest = 10;
    constexpr std::uint64_t kRest = 400;  // of the proxy, the force, the body's frame
    const core::BlobHeader& h = view_.header();
    const std::uint64_t m = h.points_per_ball_max;
    const std::uint64_t gather = m * (kPosition + kNormal) + kLeaves;
    const std::uint64_t pass = m * kCandidate + 2U * kSphere;
    const core::SurfaceWork work = core::work_per_tick(configuration_.rate_hz, scene_.work_tier());
    return work.gathers * (gather + m * kNearest) + work.passes * pass + kRest;
  }

  core::Configuration configuration_{};
  core::BlobView view_{};
  core::Scene scene_{};
  core::SceneRendering last_{};
  std::vector<std::uint32_t> words_;
};

TEST_F(Operations, OrdinaryContactTakesUnder3000) {
  std::uint32_t number = 0;
  ASSERT_EQ(scene_.add(view_, {}, number), core::ModelStatus::kOk);
  (void)tick({0.0F, 0.0F, 6e-3F}, {});
  std::uint64_t sum = 0;
  std::uint64_t ticks = 0;
  for (int i = 0; i < 4000; ++i) {  // pressed by about 1 mm, drawn at 0.1 m/s to and fro
    const double x = 0.02 * std::sin(0.005 * i);
    const Vec3 probe = {x, 0.3 * x, 2.5e-3 * (std::cos(104.72 * x) + std::cos(31.4 * x)) - 1e-3};
    const std::uint64_t now = tick(probe, {0.1, 0.0, 0.0});
    if (last_.contact.in_contact) {
      sum += now;
      ++ticks;
    }
  }
  ASSERT_GT(ticks, 3900U);
  const std::uint64_t mean = sum / ticks;
  RecordProperty("mean", static_cast<int>(mean));
  EXPECT_GT(mean, 200U);
  EXPECT_LE(mean, 3000U);
}

TEST_F(Operations, NoTickExceedsLoopBounds) {
  std::uint32_t number = 0;
  ASSERT_EQ(scene_.add(view_, {}, number), core::ModelStatus::kOk);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.01, 0.01);
  for (std::uint32_t tier = 0; tier < core::kWorkTiers; ++tier) {
    scene_.limit_work(tier);
    std::uint64_t largest = 0;
    for (int i = 0; i < 100000; ++i) {  // jumps in and out, as far as a tick may
      const bool wild = i % 50 == 0;
      const double step = wild ? 1.0 : 0.3;
      const Vec3 probe = {step * place(random), step * place(random), 3e-3 + step * place(random)};
      const std::uint64_t now = tick(probe, {});
      largest = now > largest ? now : largest;
      ASSERT_LE(now, most()) << "tick " << i << " at tier " << tier;
    }
    RecordProperty("largest at tier " + std::to_string(tier), static_cast<int>(largest));
    EXPECT_GT(largest, most() / 10U) << "the bound of tier " << tier << " says nothing";
  }
}

}  // namespace
}  // namespace tactree::test
