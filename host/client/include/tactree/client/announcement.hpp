#pragma once
// Simulated boards announce their ports to the programs of the same user: a pseudo-terminal cannot
// be distinguished from those of terminal windows. An announcement is a file in the folder
// `tactree` of XDG_RUNTIME_DIR, or without it tactree-UID of the folder for temporary files. The
// file is locked for as long as the program runs.

#include <string>
#include <vector>

namespace tactree::client {

struct AnnouncedPort {
  std::string port;
  std::string about;  ///< one line for the user
};

class Announcement {
 public:
  /// Throws LinkError if the folder cannot be used; the board can be used nevertheless.
  explicit Announcement(const AnnouncedPort& announced);
  ~Announcement();
  Announcement(const Announcement&) = delete;
  Announcement& operator=(const Announcement&) = delete;

 private:
  std::string path_;
  int descriptor_ = -1;
};

/// The ports that running programs have announced, sorted by port. Removes the announcements of
/// programs that were killed. Opens no port, so no connected program is disturbed.
[[nodiscard]] std::vector<AnnouncedPort> announced_ports();

}  // namespace tactree::client
