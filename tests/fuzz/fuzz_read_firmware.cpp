// Reads arbitrary bytes as a firmware image: it is refused with a reason, or every byte lies in the
// code memory of the board.
//
// The mutator recomputes the checksum of every other result: a wrong one ends the checks early.

#include <cstring>
#include <random>

#include "image/firmware_image.hpp"
#include "memory_file.hpp"
#include "tactree/core/math/crc32.hpp"
#include "tactree/support/user_error.hpp"

namespace {

using namespace tactree;

const cli::Unstated kPlace{"own", cli::BlobPlace{0x08020000, 0x20000}};

void examine(const cli::FirmwareImage& image) {
  fuzz::require(image.board.size() < 24, "a board without a name's end");
  fuzz::require(image.code_begin < image.code_end && image.blob_begin < image.blob_end,
                "a range of nothing");
  std::uint64_t bytes = 0;
  for (const cli::Segment& segment : image.segments) {
    fuzz::require(segment.address >= image.code_begin, "bytes before the code");
    fuzz::require(std::uint64_t{segment.address} + segment.bytes.size() <= image.code_end,
                  "bytes behind the code");
    bytes += segment.bytes.size();
  }
  fuzz::require(bytes > 0, "an image without bytes");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  for (const cli::Unstated& unstated : {cli::Unstated{}, kPlace}) {
    try {
      examine(cli::read_firmware(file.path(), unstated));
    } catch (const support::UserError& error) {
      fuzz::require_reason(error.what(), file.path().string());
    }
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned int seed) {
  std::minstd_rand random(seed + 1);
  size = LLVMFuzzerMutate(data, size, max_size);
  // Seeds end with one segment and its checksum: recompute it if the layout is intact.
  constexpr std::size_t kSegment = 52 + 32;
  if (random() % 2 == 0 && size > kSegment + 4) {
    const auto bytes = std::as_bytes(std::span(data + kSegment, size - kSegment - 4));
    const std::uint32_t checksum = core::crc32(bytes);
    std::memcpy(data + size - 4, &checksum, 4);
  }
  return size;
}
