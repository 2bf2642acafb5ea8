#pragma once
// Reads values of a JSON object in a file and checks each against its range. Every error names
// file, key, cause and hint. A key that is not read is an error.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactree/core/device/device_model.hpp"

namespace tactree::support {

class JsonReader {
 public:
  using Json = nlohmann::ordered_json;

  /// Keeps a reference to `json`. `page`: the document that describes the keys, for the hints. All
  /// functions throw UserError; the constructor throws it if `json` is not an object.
  JsonReader(std::string file, const Json& json, std::string page, std::string place = "");

  [[noreturn]] void refuse(const std::string& key, const std::string& cause,
                           const std::string& remedy) const;

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

  void one(const char* key, float& value, double low, double high);
  void each(const char* key, float (&values)[core::kAxes], double low, double high);
  [[nodiscard]] std::uint32_t whole(const char* key, std::uint32_t low, std::uint32_t high);
  [[nodiscard]] bool flag(const char* key);
  [[nodiscard]] std::string text(const char* key);
  [[nodiscard]] JsonReader object(const char* key);
  /// Returns the objects of a list, `low` to `high` in number.
  [[nodiscard]] std::vector<JsonReader> objects(const char* key, std::size_t low, std::size_t high);

  /// Throws UserError if the object has a key that was not read.
  void finish() const;

 private:
  const Json& get(const char* key);
  [[nodiscard]] std::string path(const std::string& key) const;
  [[nodiscard]] double number(const std::string& key, const Json& value, double low,
                              double high) const;

  std::string file_;
  const Json& json_;
  std::string page_;
  std::string place_;  // path of the object, such as "motors"; "" for the whole file
  std::vector<std::string> known_;
};

/// Reads a file of at most 1 MiB. Throws UserError if it cannot be read or is not JSON.
[[nodiscard]] JsonReader::Json read_json(const std::filesystem::path& file);

}  // namespace tactree::support
