// Corrupt blobs on the processor that must refuse them: cut, longer, flipped; and with a corrupt
// word under a right checksum, which is refused or harmless. The buffer ends where the blob ends.

#include <cstring>
#include <span>

#include "check.hpp"
#include "golden_blobs.hpp"
#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/nearest.hpp"

namespace tactree::test {
namespace {

using core::BlobStatus;
using core::BlobView;

std::span<std::byte> copy_of(std::span<const std::byte> bytes) {
  const std::span<std::byte> buffer = exact_buffer(bytes.size());
  std::memcpy(buffer.data(), bytes.data(), bytes.size());
  return buffer;
}

BlobStatus open(std::span<const std::byte> bytes) {
  BlobView view;
  return core::open_blob(bytes, view);
}

// The checksum covers every byte but its own four.
void seal(std::span<std::byte> blob) {
  constexpr std::size_t kAt = offsetof(core::BlobHeader, checksum);
  core::Crc32 crc;
  crc.update(blob.first(kAt));
  crc.update(blob.subspan(kAt + 4));
  const std::uint32_t value = crc.value();
  std::memcpy(blob.data() + kAt, &value, 4);
}

void use(const BlobView& view, std::uint32_t seed) {
  static core::CandidateSet scratch;
  Numbers numbers(seed);
  for (int i = 0; i < 4; ++i) {
    const core::Vec3 probe{numbers.between(-0.01F, 0.01F), numbers.between(-0.01F, 0.01F),
                           numbers.between(-0.01F, 0.01F)};
    (void)core::nearest_within(view, probe, view.reach_m());
    (void)core::in_any_vertex_box(view, probe);
    if (core::surface_support(view) == core::SurfaceSupport::kOk) {
      (void)core::project_to_surface(view, probe, scratch);
    }
    const core::PaperContact contact = core::paper_collision(view, probe);
    if (contact.in_contact) {
      (void)core::paper_nearest(view, probe, contact);
    }
  }
  std::uint32_t points = 0;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    points += cursor.leaf().point_count;
  }
  TACTREE_CHECK(points == view.point_count());
}

void test_prefixes(std::span<const std::byte> blob) {
  for (std::size_t size = 0; size < blob.size(); ++size) {
    TACTREE_CHECK(open(copy_of(blob.first(size))) != BlobStatus::kOk);
  }
}

void test_flips(std::span<const std::byte> blob) {
  const std::span<std::byte> bytes = copy_of(blob);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    TACTREE_CHECK(open(bytes) != BlobStatus::kOk);
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
  TACTREE_CHECK(open(bytes) == BlobStatus::kOk);
}

void test_resealed_words(std::span<const std::byte> blob) {
  std::uint32_t accepted = 0;
  for (std::size_t at = 0; at + 4 <= blob.size(); at += 4) {
    std::uint32_t word;
    std::memcpy(&word, blob.data() + at, 4);
    const std::uint32_t values[] = {0U,        0x7FFFFFFFU, 0xFFFFFFFFU, 0x00FFFFFFU, 0x7FC00000U,
                                    word + 1U, word - 1U,   word << 1U,  word >> 1U};
    for (const std::uint32_t value : values) {
      const std::span<std::byte> bytes = copy_of(blob);
      std::memcpy(bytes.data() + at, &value, 4);
      seal(bytes);
      BlobView view;
      if (core::open_blob(bytes, view) == BlobStatus::kOk) {
        ++accepted;
        use(view, static_cast<std::uint32_t>(at) + value);
      }
    }
  }
  TACTREE_CHECK(accepted > 0);  // normals and names may change
}

}  // namespace

void test_corrupt_blobs() {
  for (const Golden which : {Golden::kSurface, Golden::kPaper}) {
    test_prefixes(golden(which));
    test_flips(golden(which));
    test_resealed_words(golden(which));
  }
}

}  // namespace tactree::test
