// Reads arbitrary bytes as a scan: read_scan() returns a usable scan or throws ReadError, within
// its memory limit. Meshes for the import process are excluded: a process per input is too slow.
// The checksums of E57 pages are corrected, which a fuzzer cannot guess. If TACTREE_FUZZ_FORMAT is
// defined, the format is named, so that damage at the beginning reaches its reader, too.

#include <algorithm>
#include <string>
#include <string_view>

#include "e57_writer.hpp"
#include "memory_file.hpp"
#include "recognise.hpp"
#include "tactree/builder/read_scan.hpp"

#ifndef TACTREE_FUZZ_FORMAT
#define TACTREE_FUZZ_FORMAT ""
#endif

namespace {

constexpr std::uint64_t kMostPoints = 16;  // of files with an odd number of bytes

using namespace tactree::builder;
using tactree::fuzz::MemoryFile;
using tactree::fuzz::require;

void examine(const Scan& scan) {
  require(!scan.positions.empty(), "a scan without points");
  require(!scan.format.empty(), "a scan without a format");
  require(scan.normals.empty() || scan.normals.size() == scan.positions.size(),
          "the number of normals is wrong");
  require(scan.colours.empty() || scan.colours.size() == scan.positions.size(),
          "not one colour a point");
  for (const Eigen::Vector3d& p : scan.positions) {
    require(p.allFinite(), "a position is not finite");
  }
  for (const Eigen::Vector3f& n : scan.normals) {
    require(!n.hasNaN(), "a normal is NaN");
  }
  for (const auto& triangle : scan.triangles) {
    for (const std::uint32_t corner : triangle) {
      require(corner < scan.positions.size(), "a triangle names a point that does not exist");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view head(reinterpret_cast<const char*>(data), std::min(size, kHeadBytes));
  const std::string format = TACTREE_FUZZ_FORMAT;
  const FileKind kind = format.empty() ? recognise(head, size).kind : FileKind::kText;
  if (kind == FileKind::kImportedMesh) {
    return 0;
  }
  std::string sealed;
  if ((kind == FileKind::kE57 || format == "e57") && size >= 1024) {
    sealed = tactree::test::e57_resealed({reinterpret_cast<const char*>(data), size});
    data = reinterpret_cast<const std::uint8_t*>(sealed.data());
    size = sealed.size();
  }
  const MemoryFile file(data, size);
  ReadOptions options;
  options.scan_memory_bytes = std::uint64_t{1} << 26;
  options.format = format;
  options.most_points = size % 2 == 0 ? 0 : kMostPoints;
  try {
    const Scan scan = read_scan(file.path(), options);
    examine(scan);
    require(options.most_points == 0 || scan.is_mesh() ||
                !scan.dropped.contains(kBeyondMemoryLimit) || scan.positions.size() <= kMostPoints,
            "a large cloud was not thinned");
  } catch (const ReadError& error) {
    require(std::string_view(error.what()).size() > 10, "a refusal without a reason");
  }
  return 0;
}
