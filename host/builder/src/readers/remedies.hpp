#pragma once
// What a user can do about a damaged file: the same words in every reader.

namespace tactree::builder {

inline constexpr const char* kExportAgain = "export the scan again";
/// Of missing or wrong bytes.
inline constexpr const char* kCopyAgain =
    "the file was cut off or is damaged; copy or export it again";
/// Of wrong text.
inline constexpr const char* kCopyDamaged = "the file is damaged; copy or export it again";

}  // namespace tactree::builder
