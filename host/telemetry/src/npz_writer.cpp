#include "npz_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

// At 1 kHz and 26 columns, a block is 16 s and 1.6 MB.
constexpr std::uint64_t kBlockRows = 16384;
// Headers of the arrays and the directory of the archive are smaller than this.
constexpr std::uint64_t kArchiveOverhead = 65536;
// 1 January 1980, the first date of the format: equal rows give equal files.
constexpr unsigned long kNoDate = 0x00210000;

const char* descr_of(ColumnType type) {
  constexpr std::array kDescr = {"<f8", "<f4", "<u4", "<i4", "|u1"};
  return kDescr[static_cast<std::size_t>(type)];
}

/// Header of an array, format 1.0. Its data begin at a multiple of 64 bytes.
std::string npy_header(const std::string& descr, std::uint64_t rows) {
  constexpr std::size_t kFixed = 10;  // magic, version, length
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", descr, rows);
  text.append(63 - (kFixed + text.size()) % 64, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xFFU);
  header += static_cast<char>(text.size() >> 8U);
  return header + text;
}

template <class T>
void append_as(double value, std::vector<std::byte>& to) {
  const T narrow = static_cast<T>(value);
  const auto bytes = std::as_bytes(std::span(&narrow, 1));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

void append_value(ColumnType type, double value, std::vector<std::byte>& to) {
  switch (type) {
    case ColumnType::kFloat64:
      return append_as<double>(value, to);
    case ColumnType::kFloat32:
      return append_as<float>(value, to);
    case ColumnType::kUint32:
      return append_as<std::uint32_t>(value, to);
    case ColumnType::kInt32:
      return append_as<std::int32_t>(value, to);
    default:
      return append_as<std::uint8_t>(value, to);
  }
}

bool open_entry(zipFile archive, const std::string& name) {
  zip_fileinfo info{};
  info.dosDate = kNoDate;
  return zipOpenNewFileInZip64(archive, (name + ".npy").c_str(), &info, nullptr, 0, nullptr, 0,
                               nullptr, 0, 0, 1) == ZIP_OK;
}

bool write_entry(zipFile archive, std::string_view bytes) {
  // zlib restarts the checksum for a null pointer, which is the data of an empty vector.
  return bytes.empty() ||
         zipWriteInFileInZip(archive, bytes.data(), static_cast<unsigned>(bytes.size())) == ZIP_OK;
}

/// The words of a column, as an array of UCS-4 text.
bool write_words(zipFile archive, const Column& column) {
  std::size_t longest = 1;
  for (const std::string& word : column.words) {
    longest = std::max(longest, word.size());
  }
  std::string array = npy_header(fmt::format("<U{}", longest), column.words.size());
  for (const std::string& word : column.words) {
    for (std::size_t i = 0; i < longest; ++i) {
      array += i < word.size() ? word[i] : '\0';
      array.append(3, '\0');
    }
  }
  return open_entry(archive, column.name + "_names") && write_entry(archive, array) &&
         zipCloseFileInZip(archive) == ZIP_OK;
}

struct CloseArchive {
  void operator()(void* archive) const { (void)zipClose(archive, nullptr); }
};

/// A file without a name in the folder of `file`; below 0 on failure.
int open_unnamed(const std::string& file) {
  std::string name = file + ".XXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) {
    ::unlink(name.c_str());
  }
  return descriptor;
}

/// Returns 0 or the error.
int write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno != EINTR) {
      return errno;
    }
    const std::size_t written = count < 0 ? 0U : static_cast<std::size_t>(count);
    bytes = bytes.subspan(written);
    offset += written;
  }
  return 0;
}

}  // namespace

NpzWriter::NpzWriter(const std::filesystem::path& file, std::vector<Column> columns)
    : name_(file.string()),
      columns_(std::move(columns)),
      file_(file),
      rows_file_(open_unnamed(name_)),
      block_(columns_.size()) {
  if (rows_file_ < 0) {
    fail(errno);
  }
  for (const Column& column : columns_) {
    row_bytes_ += bytes_of(column.type);
  }
}

NpzWriter::~NpzWriter() {
  if (rows_file_ >= 0) {
    ::close(rows_file_);
  }
}

void NpzWriter::append(std::span<const double> row) {
  if (block_rows_ == kBlockRows) {
    write_block();
  }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    append_value(columns_[i].type, row[i], block_[i]);
  }
  ++block_rows_;
}

// A block has room for kBlockRows of each column, also the last one.
void NpzWriter::write_block() {
  std::uint64_t offset = written_ * row_bytes_;
  const std::uint64_t reserved = offset + kBlockRows * row_bytes_ + kArchiveOverhead;
  if (const int error = file_.reserve(reserved); error != 0) {
    fail(error);
  }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (const int error = write_at(rows_file_, block_[i], offset); error != 0) {
      fail(error);
    }
    offset += kBlockRows * bytes_of(columns_[i].type);
  }
  for (std::vector<std::byte>& column : block_) {
    column.clear();
  }
  written_ += block_rows_;
  block_rows_ = 0;
}

/// Copies a column whose values begin `offset` bytes after the begin of each block.
void NpzWriter::write_column(void* archive, std::size_t column, std::uint64_t offset) {
  const std::size_t value_bytes = bytes_of(columns_[column].type);
  std::string bytes = npy_header(descr_of(columns_[column].type), written_ + block_rows_);
  bool good = open_entry(archive, columns_[column].name) && write_entry(archive, bytes);
  for (std::uint64_t row = 0; good && row < written_; row += kBlockRows) {
    bytes.resize(kBlockRows * value_bytes);
    good = ::pread(rows_file_, bytes.data(), bytes.size(),
                   static_cast<off_t>(row * row_bytes_ + offset)) ==
               static_cast<ssize_t>(bytes.size()) &&
           write_entry(archive, bytes);
  }
  const std::vector<std::byte>& last = block_[column];
  good = good && write_entry(archive, {reinterpret_cast<const char*>(last.data()), last.size()}) &&
         zipCloseFileInZip(archive) == ZIP_OK;
  if (!good) {
    fail(errno);
  }
}

void NpzWriter::finish() {
  errno = 0;
  std::unique_ptr<void, CloseArchive> archive(
      zipOpen64(file_.temporary().c_str(), APPEND_STATUS_CREATE));
  if (archive == nullptr) {
    fail(errno);
  }
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    write_column(archive.get(), i, offset);
    offset += kBlockRows * bytes_of(columns_[i].type);
    if (!columns_[i].words.empty() && !write_words(archive.get(), columns_[i])) {
      fail(errno);
    }
  }
  if (zipClose(archive.release(), nullptr) != ZIP_OK) {
    fail(errno);
  }
  file_.finish();
}

void NpzWriter::fail(int error) const {
  throw support::UserError(
      fmt::format("{}: cannot be written: {} (make room on the disk: twice the size of the file)",
                  name_, std::strerror(error == 0 ? EIO : error)));
}

}  // namespace tactree::telemetry
