// Requirements B1 and B2: open_blob() reads only the bytes of the blob; for an accepted blob, no
// query reads outside of it, loops, or returns a wrong result.
//
// The input is a blob. The mutator changes words as often as bytes and recomputes the checksum of
// every other result: with a wrong checksum the structural checks are not reached.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "leaf_set.hpp"
#include "memory_file.hpp"
#include "tactree/builder/model.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/nearest.hpp"
#include "tactree/core/model/octree.hpp"

namespace {

using namespace tactree::core;
using tactree::fuzz::require;

/// A copy of the bytes in memory of exactly that size, for AddressSanitizer.
class ExactCopy {
 public:
  ExactCopy(const std::uint8_t* data, std::size_t size)
      : size_(size), bytes_(new std::byte[size]) {  // aligned for any type of this size or less
    if (size > 0) {
      std::memcpy(bytes_.get(), data, size);
    }
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return {bytes_.get(), size_}; }

 private:
  std::size_t size_;
  std::unique_ptr<std::byte[]> bytes_;
};

struct PlacedPoint {
  double x, y, z;
  std::uint32_t index;
};

class Examination {
 public:
  Examination(const BlobView& view, std::uint32_t seed) : view_(view), random_(seed) {}

  void run() {
    walk();
    for (int i = 0; i < 8; ++i) {
      const Vec3 probe = make_probe(i);
      find(probe);
      ask(probe, view_.reach_m());
      ask(probe, view_.reach_m() * unit_random());
      ask_paper(probe);
    }
    ask(make_probe(0), 0.0F);
    refuse_radius(std::nextafter(view_.reach_m(), std::numeric_limits<float>::infinity()));
    refuse_radius(std::numeric_limits<float>::quiet_NaN());
    refuse_radius(-1.0F);
    render();
  }

 private:
  // Every leaf and point once, in order, each point within its leaf.
  void walk() {
    std::uint32_t leaves = 0;
    for (LeafCursor cursor(view_); !cursor.done(); cursor.next()) {
      const Leaf& leaf = cursor.leaf();
      require(leaf.number == leaves++, "a leaf is out of order");
      require(leaf.first_point == points_.size(), "a leaf does not begin where the last one ended");
      require(leaf.point_count > 0 && leaf.point_count <= view_.header().points_per_leaf_max,
              "a leaf holds more points than declared");
      for (std::uint32_t p = 0; p < leaf.point_count; ++p) {
        examine_point(leaf, leaf.first_point + p);
      }
    }
    require(leaves == view_.header().leaf_count, "the walk missed leaves");
    require(points_.size() == view_.point_count(), "the walk missed points");
  }

  void examine_point(const Leaf& leaf, std::uint32_t index) {
    const SurfacePoint point = view_.surface_point(leaf, index);
    require(is_finite(point.position), "a decoded position is not finite");
    require(std::abs(length(point.normal) - 1.0F) < 1e-5F, "a normal has not unit length");
    Leaf found;
    require(find_leaf(view_, point.position, found) && found.number == leaf.number,
            "a point is not in the leaf that holds it");
    if (view_.material_count() > 0) {
      require(view_.material_of(index) < view_.material_count(), "a point has no such material");
    }
    points_.push_back({static_cast<double>(point.position.x), static_cast<double>(point.position.y),
                       static_cast<double>(point.position.z), index});
  }

  float unit_random() { return std::uniform_real_distribution<float>(0.0F, 1.0F)(random_); }

  Vec3 make_probe(int kind) {
    const BlobHeader& h = view_.header();
    const float reach = 1.5F * view_.reach_m();
    const auto near_point = [&] {
      const PlacedPoint& p = points_[random_() % points_.size()];
      const auto shift = [&] { return reach * (2.0F * unit_random() - 1.0F); };
      return Vec3{static_cast<float>(p.x) + shift(), static_cast<float>(p.y) + shift(),
                  static_cast<float>(p.z) + shift()};
    };
    switch (kind) {
      case 0: {  // on a point
        const PlacedPoint& p = points_[random_() % points_.size()];
        return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      }
      case 1: {  // on a corner between leaves
        const auto corner = [&](std::int32_t low) {
          const auto cells = static_cast<std::int32_t>(random_() % ((1U << h.depth) + 1U));
          return h.step_m * static_cast<float>(low + (cells << kLeafShift));
        };
        return {corner(h.root_min[0]), corner(h.root_min[1]), corner(h.root_min[2])};
      }
      case 2: {  // in or around the root
        const auto axis = [&](std::uint32_t i) {
          const float edge = h.step_m * static_cast<float>(kLeafUnits << h.depth);
          return h.step_m * static_cast<float>(h.root_min[i]) +
                 edge * (1.2F * unit_random() - 0.1F);
        };
        return {axis(0), axis(1), axis(2)};
      }
      case 3:  // any float
        return {std::bit_cast<float>(static_cast<std::uint32_t>(random_())),
                std::bit_cast<float>(static_cast<std::uint32_t>(random_())),
                std::bit_cast<float>(static_cast<std::uint32_t>(random_()))};
      default:
        return near_point();
    }
  }

  void find(Vec3 probe) {
    Int3 site;
    Leaf leaf;
    if (!to_lattice(view_, probe, site)) {
      require(!find_leaf(view_, probe, leaf), "a leaf outside the root");
      return;
    }
    require(view_.step_m() * static_cast<float>(site.x) <= probe.x &&
                probe.x < view_.step_m() * static_cast<float>(site.x + 1),
            "to_lattice() is off");
    const tactree::test::LeafSet set = tactree::test::leaves_within(view_, probe, 0.0F);
    if (find_leaf(view_, site, leaf)) {
      require(set.count > 0 && set.leaves[0].number == leaf.number,
              "the eight-corner rule misses the leaf of the centre");
    }
  }

  // Rounding of a distance between coordinates of this size; anything closer is a tie.
  [[nodiscard]] double tolerance(Vec3 probe) const {
    const double size =
        std::max({std::abs(static_cast<double>(probe.x)), std::abs(static_cast<double>(probe.y)),
                  std::abs(static_cast<double>(probe.z)),
                  static_cast<double>(view_.header().leaf_edge_min_m) *
                      static_cast<double>(1U << view_.depth())});
    return 1e-6 * size;
  }

  [[nodiscard]] static double distance(const PlacedPoint& p, Vec3 probe) {
    return std::hypot(p.x - static_cast<double>(probe.x), p.y - static_cast<double>(probe.y),
                      p.z - static_cast<double>(probe.z));
  }

  void ask(Vec3 probe, float r) {
    const NearestPoint nearest = nearest_within(view_, probe, r);
    if (!is_finite(probe)) {
      require(!nearest.found(), "a point near a probe that is nowhere");
      return;
    }
    compare_with_all_points(probe, r, nearest);
    const bool boxed = in_any_vertex_box(view_, probe);
    const float half = 0.5F * view_.header().aabb_edge_m;
    require(!boxed || half <= view_.reach_m(), "a vertex box beyond the reach");
  }

  void compare_with_all_points(Vec3 probe, float r, const NearestPoint& nearest) {
    const double slack = tolerance(probe);
    const double limit = static_cast<double>(r);
    double best = std::numeric_limits<double>::infinity();
    for (const PlacedPoint& p : points_) {
      best = std::min(best, distance(p, probe));
    }
    require(nearest.found() || best > limit - slack, "the nearest point was missed");
    if (nearest.found()) {
      require(nearest.index < points_.size(), "nearest_within() names a point that does not exist");
      require(distance(points_[nearest.index], probe) < limit + slack, "a point beyond r");
      require(distance(points_[nearest.index], probe) < best + slack, "a nearer point was missed");
    }
  }

  void ask_paper(Vec3 probe) {
    const PaperContact contact = paper_collision(view_, probe);
    if (!contact.in_contact) {
      return;
    }
    require(contact.leaf.number < view_.header().leaf_count, "contact with a leaf that is none");
    const NearestPoint nearest = paper_nearest(view_, probe, contact);
    require(nearest.found() && nearest.index < view_.point_count(), "contact without a point");
  }

  void refuse_radius(float r) {
    require(!nearest_within(view_, make_probe(0), r).found(), "an answer beyond the reach");
  }

  // The steps of the controller with an accepted model.
  void render() {
    Configuration configuration;
    const bool surface = surface_support(view_) == SurfaceSupport::kOk;
    configuration.mode = surface ? RenderMode::kSurface : RenderMode::kPaper;
    Scene scene;
    std::uint32_t number = 0;
    require(scene.add(view_, {}, number) == ModelStatus::kOk, "an accepted model is no body");
    Vec3 probe = make_probe(0);
    scene.reset(probe);
    for (int tick = 0; tick < 6; ++tick) {
      const Rendering rendering = scene.update(configuration, probe, {}).contact;
      require(!rendering.in_contact || is_finite(rendering.proxy), "a proxy is nowhere");
      probe = make_probe(tick == 3 ? 2 : 5);
    }
    if (surface) {
      const SurfaceProjection projection = project_to_surface(view_, make_probe(5));
      require(!projection.supported || is_finite(projection.normal), "a normal is not finite");
    }
  }

  BlobView view_;
  std::minstd_rand random_;
  std::vector<PlacedPoint> points_;
};

void examine_empty(const BlobView& view) {
  require(view.empty(), "a refused blob left a view behind");
  require(!nearest_within(view, {}, 0.0F).found(), "the empty model has a point");
  require(!paper_collision(view, {}).in_contact, "the empty model is touched");
  require(LeafCursor(view).done(), "the empty model has a leaf");
}

// Values at the boundaries of comparisons.
std::uint32_t interesting_word(std::uint32_t old, std::minstd_rand& random) {
  static constexpr std::uint32_t kWords[] = {0,          1,          2,          3,
                                             8,          0x7FFFFFFF, 0x80000000, 0xFFFFFFFF,
                                             0x00FFFFFF, 0x01000000, 0x7F800000, 0x7FC00000,
                                             0x3F800000, 0x00000001, 0xFFFFFFFE, 0x00400000};
  switch (random() % 6) {
    case 0:
      return old + 1;
    case 1:
      return old - 1;
    case 2:
      return old ^ 1U << random() % 32;
    case 3:
      return old ^ (1U << random() % 32 | 1U << random() % 32);
    case 4:
      return old + 4;
    default:
      return kWords[random() % std::size(kWords)];
  }
}

void change_word(std::span<std::byte> blob, std::minstd_rand& random) {
  const std::size_t words = blob.size() / 4;
  // Half of the changes in the header.
  const std::size_t range = random() % 2 == 0 ? std::min(words, sizeof(BlobHeader) / 4) : words;
  if (range == 0) {
    return;
  }
  std::byte* const at = blob.data() + 4 * (random() % range);
  std::uint32_t word = 0;
  if (random() % 8 == 0) {  // a word from another place
    std::memcpy(&word, blob.data() + 4 * (random() % words), 4);
  } else {
    std::memcpy(&word, at, 4);
    word = interesting_word(word, random);
  }
  std::memcpy(at, &word, 4);
}

void repair(std::span<std::byte> blob) {
  const auto size = static_cast<std::uint32_t>(blob.size());
  std::memcpy(blob.data() + offsetof(BlobHeader, total_bytes), &size, sizeof size);
  tactree::builder::seal(blob);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
  std::minstd_rand random(seed);
  (void)random();  // discards the first number, which is similar for similar seeds
  if (random() % 3 == 0) {
    size = LLVMFuzzerMutate(data, size, max_size);
  } else {
    const unsigned changes = 1 + static_cast<unsigned>(random() % 3);
    for (unsigned i = 0; i < changes; ++i) {
      change_word(std::as_writable_bytes(std::span(data, size)), random);
    }
  }
  if (random() % 2 == 0 && size >= sizeof(BlobHeader)) {
    repair(std::as_writable_bytes(std::span(data, size)));
  }
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ExactCopy copy(data, size);
  BlobView view;
  if (open_blob(copy.bytes(), view) == BlobStatus::kOk) {
    Examination(view, crc32(copy.bytes())).run();
  } else {
    examine_empty(view);
  }
  return 0;
}
