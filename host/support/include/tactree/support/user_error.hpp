#pragma once
// An error in a file, option or value that the user gave.

#include <stdexcept>
#include <string>

namespace tactree::support {

/// The text is "file: place: cause (hint)", without the parts that do not apply.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void refuse(const std::string& place, const std::string& cause,
                                const std::string& remedy) {
  throw UserError(place + ": " + cause + " (" + remedy + ")");
}

}  // namespace tactree::support
