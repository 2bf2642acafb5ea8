#pragma once
// Exit codes of the programs.

namespace tactree {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

}  // namespace tactree
