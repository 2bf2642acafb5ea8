#pragma once
// Reads a recording in an .npz, column by column: a zip archive with one array NAME.npy for each
// column, as open_tick_file() writes it.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace tactree::telemetry {

/// All members throw UserError; an array is refused if its checksum, type or length is wrong.
class NpzReader {
 public:
  /// Opens the archive. Arrays of more than `rows_max` values are refused before they are read.
  NpzReader(const std::filesystem::path& file, std::size_t rows_max);
  ~NpzReader();
  NpzReader(const NpzReader&) = delete;
  NpzReader& operator=(const NpzReader&) = delete;

  [[nodiscard]] bool has(const std::string& column) const;
  /// The values of a column of numbers. A double holds each of them exactly.
  [[nodiscard]] std::vector<double> values(const std::string& column) const;
  /// The words of a column of words: the elements of the array NAME_names.
  [[nodiscard]] std::vector<std::string> words(const std::string& column) const;

  /// Throws UserError about an array of this file.
  [[noreturn]] void refuse(const std::string& array, const std::string& cause,
                           const std::string& remedy = "record the session again") const;

 private:
  struct Array;

  [[nodiscard]] Array read(const std::string& array) const;
  void read_header(const std::string& array, Array& result) const;

  std::string name_;
  std::size_t rows_max_;
  void* archive_;
};

}  // namespace tactree::telemetry
