#include "tactree/telemetry/npz_reader.hpp"

#include <unzip.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>

#include "tactree/support/user_error.hpp"

namespace tactree::telemetry {
namespace {

static_assert(std::endian::native == std::endian::little, "values are copied as they are");

constexpr std::size_t kPrefix = 10;     // magic, version, length of the header
constexpr std::size_t kMaxWord = 1000;  // characters
constexpr std::size_t kUcs4 = 4;        // bytes of a character
constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);
constexpr char kOtherFile[] = "give a file that tactree record wrote";

/// The text between `before` and `after`; empty if there is none.
std::string_view between(std::string_view text, std::string_view before, std::string_view after) {
  const std::size_t found = text.find(before);
  if (found == std::string_view::npos) {
    return {};
  }
  text.remove_prefix(found + before.size());
  return text.substr(0, std::min(text.find(after), text.size()));
}

std::size_t number_of(std::string_view digits) {
  std::size_t number = 0;
  const char* const end = digits.data() + digits.size();
  const auto [parsed, error] = std::from_chars(digits.data(), end, number);
  return error == std::errc() && parsed == end ? number : SIZE_MAX;
}

template <class T>
std::vector<double> widened(std::string_view data) {
  std::vector<double> values;
  values.reserve(data.size() / sizeof(T));
  for (; data.size() >= sizeof(T); data.remove_prefix(sizeof(T))) {
    T value{};
    std::memcpy(&value, data.data(), sizeof(T));
    values.push_back(static_cast<double>(value));
  }
  return values;
}

std::size_t width_of(std::string_view type) {
  if (type.starts_with("<U")) {
    const std::size_t characters = number_of(type.substr(2));
    return characters > kMaxWord ? 0 : characters * kUcs4;
  }
  return type == "<f8"                    ? 8
         : type == "<f4" || type == "<u4" ? 4
         : type == "<i4"                  ? 4
         : type == "|u1" || type == "|b1" ? 1
                                          : 0;
}

}  // namespace

struct NpzReader::Array {
  std::string bytes;
  std::string type;
  std::size_t begin = 0;  // of the data

  [[nodiscard]] std::string_view data() const { return std::string_view(bytes).substr(begin); }
};

NpzReader::NpzReader(const std::filesystem::path& file, std::size_t rows_max)
    : name_(file.string()), rows_max_(rows_max), archive_(nullptr) {
  errno = 0;
  if (!std::ifstream(file)) {
    support::refuse(name_, std::string("cannot be read: ") + std::strerror(errno),
                    "check the path and its permissions");
  }
  archive_ = unzOpen64(file.c_str());
  if (archive_ == nullptr) {
    support::refuse(name_, "not an archive of NumPy, or it is truncated", kOtherFile);
  }
}

NpzReader::~NpzReader() { unzClose(archive_); }

bool NpzReader::has(const std::string& column) const {
  return unzLocateFile(archive_, (column + ".npy").c_str(), 1) == UNZ_OK;
}

NpzReader::Array NpzReader::read(const std::string& array) const {
  unz_file_info64 info{};
  if (!has(array)) {
    refuse(array, "is missing", kOtherFile);
  }
  if (unzGetCurrentFileInfo64(archive_, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK) {
    refuse(array, "the archive is damaged");
  }
  constexpr std::size_t kMaxHeader = kPrefix + 0xFFFF;
  if (info.uncompressed_size > kMaxHeader + rows_max_ * sizeof(double)) {
    refuse(array, "more than " + std::to_string(rows_max_) + " values",
           "record for a shorter time, or with --every 10");
  }
  Array result;
  result.bytes.resize(static_cast<std::size_t>(info.uncompressed_size));
  const int count = static_cast<int>(result.bytes.size());
  const bool is_read =
      unzOpenCurrentFile(archive_) == UNZ_OK &&
      unzReadCurrentFile(archive_, result.bytes.data(), static_cast<unsigned>(count)) == count;
  if (unzCloseCurrentFile(archive_) != UNZ_OK || !is_read) {
    refuse(array, "the archive is damaged");
  }
  read_header(array, result);
  return result;
}

void NpzReader::read_header(const std::string& array, Array& result) const {
  const std::string_view bytes = result.bytes;
  if (bytes.size() < kPrefix || !bytes.starts_with(kMagic)) {
    refuse(array, "not an array of NumPy, format 1.0", kOtherFile);
  }
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); };
  result.begin = kPrefix + byte(8) + (std::size_t{byte(9)} << 8U);
  const std::string_view header = bytes.substr(0, result.begin);
  result.type = between(header, "'descr': '", "'");
  const std::size_t width = width_of(result.type);
  if (width == 0U) {
    refuse(array, "values of type '" + result.type + "'", kOtherFile);
  }
  const std::size_t rows = number_of(between(header, "'shape': (", ",)"));
  if (rows > rows_max_ || result.begin > bytes.size() ||
      bytes.size() - result.begin != rows * width) {
    refuse(array, "its length is not that of its header");
  }
}

std::vector<double> NpzReader::values(const std::string& column) const {
  const Array array = read(column);
  const std::string_view data = array.data();
  const std::string_view type = array.type;
  if (type == "<f8") {
    return widened<double>(data);
  }
  if (type == "<f4") {
    return widened<float>(data);
  }
  if (type == "<u4") {
    return widened<std::uint32_t>(data);
  }
  if (type == "<i4") {
    return widened<std::int32_t>(data);
  }
  if (type.starts_with("<U")) {
    refuse(column, "has words instead of numbers", kOtherFile);
  }
  return widened<std::uint8_t>(data);
}

std::vector<std::string> NpzReader::words(const std::string& column) const {
  const std::string name = column + "_names";
  const Array array = read(name);
  if (!array.type.starts_with("<U")) {
    refuse(name, "has numbers instead of words", kOtherFile);
  }
  const std::size_t width = width_of(array.type);
  std::vector<std::string> words;
  for (std::string_view data = array.data(); !data.empty(); data.remove_prefix(width)) {
    std::string word;
    for (std::size_t i = 0; i < width && data[i] != '\0'; i += kUcs4) {
      word += data[i];  // the words of a recording are ASCII
    }
    words.push_back(word);
  }
  return words;
}

void NpzReader::refuse(const std::string& array, const std::string& cause,
                       const std::string& remedy) const {
  support::refuse(name_ + ": " + array, cause, remedy);
}

}  // namespace tactree::telemetry
