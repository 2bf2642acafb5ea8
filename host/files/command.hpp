#pragma once
// Exit codes of the programs, and the error that ends a verb.

#include <stdexcept>
#include <string>

namespace tactree::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

/// Ends a verb with exit code 1. The text is "file: place: cause (remedy)", without the parts that
/// do not apply.
class CommandError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void refuse(const std::string& place, const std::string& cause,
                                const std::string& remedy) {
  throw CommandError(place + ": " + cause + " (" + remedy + ")");
}

}  // namespace tactree::cli
