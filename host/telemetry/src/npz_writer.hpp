#pragma once
// Writes a table as an .npz file of NumPy: a zip archive with one array NAME.npy for each column. A
// column of words has their indices, and the words are in an array NAME_names.npy.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "tactree/support/output_file.hpp"
#include "tactree/telemetry/tick_table.hpp"

namespace tactree::telemetry {

/// The rows wait in a file without a name beside the output; finish() copies them into the archive,
/// uncompressed. The space for the archive is reserved as the rows are written, so a full disk does
/// not lose rows. Memory: one block of rows. All members throw UserError.
class NpzWriter {
 public:
  NpzWriter(const std::filesystem::path& file, std::vector<Column> columns);
  ~NpzWriter();
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  /// One value for each column.
  void append(std::span<const double> row);
  void finish();

 private:
  void write_block();
  void write_column(void* archive, std::size_t column, std::uint64_t offset);
  [[noreturn]] void fail(int error) const;

  std::string name_;
  std::vector<Column> columns_;
  std::uint64_t row_bytes_ = 0;
  support::GrowingFile file_;
  int rows_file_ = -1;
  std::vector<std::vector<std::byte>> block_;  // by column
  std::uint64_t block_rows_ = 0;
  std::uint64_t written_ = 0;  // rows before the block
};

}  // namespace tactree::telemetry
