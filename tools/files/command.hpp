#pragma once
// What the verbs share: exit codes and the error a verb ends with.

#include <stdexcept>
#include <string>

namespace tactree::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

/// Ends a verb with exit code 1. The text is "file: place: cause (remedy)", as far as it applies.
class CommandError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void refuse(const std::string& place, const std::string& cause,
                                const std::string& remedy) {
  throw CommandError(place + ": " + cause + " (" + remedy + ")");
}

}  // namespace tactree::cli
