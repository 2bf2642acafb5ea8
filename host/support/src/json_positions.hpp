#pragma once
// Where the keys and values of a JSON text are, for messages. nlohmann::json does not keep
// positions.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::support {

/// Line and column of a character, counted from 1. A column is a character of UTF-8.
struct TextPosition {
  std::size_t line = 1;
  std::size_t column = 1;
};

/// Position of the byte `offset`; of the end of the text if it is beyond.
[[nodiscard]] TextPosition position_of(std::string_view text, std::size_t offset);

struct JsonError {
  std::size_t offset = 0;
  std::string cause;
};

/// Returns the first place at which `text` is not JSON or has a number beyond the range of a
/// double.
[[nodiscard]] std::optional<JsonError> find_json_error(std::string_view text);

/// Offsets of the members of an object and of the items of their lists. Deeper values are skipped.
class JsonPositions {
 public:
  /// Precondition: find_json_error(text) finds none.
  explicit JsonPositions(std::string_view text);

  /// Offset of a key, or of the first character of a value, whose path is of the form "joint_min"
  /// or "joint_min[1]"; that of the outermost value if there is none.
  [[nodiscard]] std::size_t key(const std::string& key) const;
  [[nodiscard]] std::size_t value(const std::string& path) const;

  struct Repetition {
    std::string key;
    std::size_t offset = 0;
    std::size_t first = 0;  ///< offset of the first of these keys
  };
  /// Keys of the outermost object that occur again, of which JSON readers keep the last.
  [[nodiscard]] const std::vector<Repetition>& repetitions() const { return repetitions_; }

 private:
  class Scan;

  std::map<std::string, std::size_t> keys_;
  std::map<std::string, std::size_t> values_;
  std::vector<Repetition> repetitions_;
  std::size_t root_ = 0;
};

}  // namespace tactree::support
