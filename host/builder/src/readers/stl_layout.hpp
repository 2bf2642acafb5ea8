#pragma once
// The layout of a binary STL: 80 bytes of text, a count, and 50 bytes for each triangle (normal,
// three vertices, two bytes of attributes). It has no magic number.

#include <cstdint>
#include <optional>
#include <string_view>

namespace tactree::builder {

inline constexpr std::size_t kStlHeaderBytes = 84;
inline constexpr std::size_t kStlCountByte = 80;
inline constexpr std::size_t kStlTriangleBytes = 50;
inline constexpr std::size_t kStlCornersByte = 12;  // in a triangle

/// True if the count agrees exactly with the file size.
[[nodiscard]] bool is_exact_binary_stl(std::string_view head, std::uint64_t file_size);

/// Offset of the first triangle of a binary STL, if the first triangles are plausible: after the
/// count, or in its place if the file has none. The count itself may be wrong.
[[nodiscard]] std::optional<std::size_t> find_stl_triangles(std::string_view head,
                                                            std::uint64_t file_size);

}  // namespace tactree::builder
