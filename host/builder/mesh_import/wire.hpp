#pragma once
// Output format of the mesh import process, read by the builder through a pipe:
//   WireHeader
//   text_bytes bytes of text      cause of a refusal, or a warning (may be empty)
//   then, with status kOk:
//   points times                  3 double  position
//                                 3 float   normal, with kHasNormals
//                                 3 bytes   colour (R, G, B), with kHasColours
//   triangles times               3 uint32  indices of points
//   kWireEnd
// Native byte order, because both processes run on the same machine.

#include <array>
#include <cstdint>
#include <type_traits>

namespace tactree::builder {

enum class WireStatus : std::uint32_t { kOk = 0, kRefused = 1, kOutOfMemory = 2 };

inline constexpr std::array<char, 8> kWireMagic = {'T', 'A', 'C', 'M', 'E', 'S', 'H', '2'};
inline constexpr std::array<char, 8> kWireEnd = {'T', 'A', 'C', 'E', 'N', 'D', '.', '.'};
inline constexpr std::uint32_t kHasNormals = 1;
inline constexpr std::uint32_t kHasColours = 2;
inline constexpr std::uint32_t kMaxWireText = 4096;

struct WireHeader {
  std::array<char, 8> magic = kWireMagic;
  std::uint32_t status = 0;
  std::uint32_t flags = 0;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
  std::uint32_t text_bytes = 0;
  std::uint32_t reserved = 0;
  double unit_m = 0.0;  ///< metres per unit of the positions; 0: unknown
};
static_assert(sizeof(WireHeader) == 48 && std::is_trivially_copyable_v<WireHeader>);

}  // namespace tactree::builder
