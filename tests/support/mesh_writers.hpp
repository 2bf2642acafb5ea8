#pragma once
// Writes small mesh files for tests: glTF with any accessors, and zip archives such as 3MF.

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tactree::test {

template <typename Number>
std::string raw_bytes(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  if (!numbers.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

inline std::string little(std::uint64_t value, unsigned size) {
  std::string bytes;
  for (unsigned k = 0; k < size; ++k) {
    bytes.push_back(static_cast<char>(k < sizeof value ? value >> (8 * k) & 0xff : 0));
  }
  return bytes;
}

/// A glTF file as its JSON and the bytes of its binary part.
struct GltfWriter {
  nlohmann::json root = nlohmann::json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": []}], "accessors": [], "bufferViews": []})");
  std::string data;

  /// Adds an accessor over numbers of its own and returns its index.
  template <typename Number>
  std::size_t add(const std::vector<Number>& numbers, int component, const std::string& type,
                  std::size_t width, std::size_t stride = 0) {
    data.resize((data.size() + 3) / 4 * 4);
    const std::size_t offset = data.size();
    const std::string bytes = raw_bytes(numbers);
    const std::size_t row = width * sizeof(Number);
    for (std::size_t at = 0; at < bytes.size(); at += row) {
      data += bytes.substr(at, row);
      if (stride > row) data.append(stride - row, '\x55');
    }
    nlohmann::json view = {
        {"buffer", 0}, {"byteOffset", offset}, {"byteLength", data.size() - offset}};
    if (stride != 0) view["byteStride"] = stride;
    root["bufferViews"].push_back(view);
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", numbers.size() / width},
                                 {"type", type}});
    return root["accessors"].size() - 1;
  }

  std::string glb() const {
    nlohmann::json whole = root;
    if (!whole.contains("buffers")) whole["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + little(2, 4) + little(28 + text.size() + data.size(), 4) +
           little(text.size(), 4) + "JSON" + text + little(data.size(), 4) +
           std::string("BIN\0", 4) + data;
  }
};

/// A zip archive; its members are packed unless `stored`.
class ZipWriter {
 public:
  explicit ZipWriter(bool stored = false, bool long_sizes = false)
      : stored_(stored), long_sizes_(long_sizes) {}

  ZipWriter& add(const std::string& path, const std::string& content) {
    const std::string packed = stored_ ? content : deflated(content);
    const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(content.data()),
                             static_cast<uInt>(content.size()));
    const std::string method = little(stored_ ? 0 : 8, 2);
    const std::string extra = long_sizes_ ? little(1, 2) + little(16, 2) +
                                                little(content.size(), 8) + little(packed.size(), 8)
                                          : "";
    const auto size = [&](std::size_t value) {
      return little(long_sizes_ ? 0xffffffff : value, 4);
    };
    const std::string common = little(20, 2) + little(0, 2) + method + little(0, 4) +
                               little(sum, 4) + size(packed.size()) + size(content.size()) +
                               little(path.size(), 2) + little(extra.size(), 2);
    directory_ += "PK\x01\x02" + little(20, 2) + common + little(0, 10) + little(data_.size(), 4) +
                  path + extra;
    data_ += "PK\x03\x04" + common + path + extra + packed;
    ++count_;
    return *this;
  }

  std::string bytes() const {
    return data_ + directory_ + "PK\x05\x06" + little(0, 4) + little(count_, 2) +
           little(count_, 2) + little(directory_.size(), 4) + little(data_.size(), 4) +
           little(0, 2);
  }

 private:
  static std::string deflated(const std::string& content) {
    z_stream stream{};
    (void)::deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string packed(::deflateBound(&stream, content.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    (void)::deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    ::deflateEnd(&stream);
    return packed;
  }

  bool stored_;
  bool long_sizes_;
  std::string data_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

}  // namespace tactree::test
