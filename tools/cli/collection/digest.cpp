#include "collection/digest.hpp"

#include <sodium.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "image/model_signature.hpp"
#include "tactree/support/uri.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

// They choose the objects, the outputs or the messages, not the bytes of a blob.
const std::set<std::string>& other_options() {
  static const std::set<std::string> kNames = {
      "--collection", "--part", "--collect", "--output", "--threads", "--progress", "--json",
  };
  return kNames;
}

class Sha256 {
 public:
  Sha256() {
    if (::sodium_init() < 0) {
      throw std::runtime_error("libsodium cannot be initialised (check the installation)");
    }
    ::crypto_hash_sha256_init(&state_);
  }
  void add(std::string_view bytes) {
    ::crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(bytes.data()),
                                bytes.size());
  }
  [[nodiscard]] std::string hex() {
    std::array<std::uint8_t, crypto_hash_sha256_BYTES> digest{};
    ::crypto_hash_sha256_final(&state_, digest.data());
    return to_hex(digest);
  }

 private:
  crypto_hash_sha256_state state_{};
};

/// The files that hold the buffers of a glTF. Empty for any other scan.
std::vector<fs::path> buffer_files(const fs::path& scan) {
  std::error_code ignored;
  std::vector<fs::path> files;
  std::ifstream in;
  if (fs::is_regular_file(scan, ignored)) {
    in.open(scan, std::ios::binary);
  }
  if ((in >> std::ws).peek() != '{') {
    return files;
  }
  const nlohmann::json document = nlohmann::json::parse(in, nullptr, false);
  if (!document.is_object() || !document.contains("buffers")) {
    return files;
  }
  for (const nlohmann::json& buffer : document["buffers"]) {
    if (buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string()) {
      files.push_back(scan.parent_path() / support::decoded_uri(buffer["uri"].get<std::string>()));
    }
  }
  return files;
}

}  // namespace

std::string digest_of_file(const fs::path& file) {
  Sha256 digest;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return digest.hex();
  }
  std::ifstream in(file, std::ios::binary);
  std::vector<char> buffer(1 << 20);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
    digest.add({buffer.data(), static_cast<std::size_t>(in.gcount())});
  }
  return digest.hex();
}

std::string digest_of_options(const CLI::App& build) {
  Sha256 digest;
  digest.add("tactree " TACTREE_VERSION);
  for (const CLI::Option* option : build.get_options()) {
    if (option->count() == 0 || other_options().contains(option->get_name())) {
      continue;
    }
    digest.add("\n" + option->get_name());
    for (const std::string& value : option->results()) {
      // --fit names the file of a device as device:FILE.
      const std::string file = value.starts_with("device:") ? value.substr(7) : value;
      digest.add("\n=" + value + "\n" + digest_of_file(file));
    }
  }
  return digest.hex();
}

std::string digest_of_object(const std::string& options, const fs::path& scan) {
  Sha256 digest;
  digest.add(options + digest_of_file(scan));
  for (const fs::path& file : buffer_files(scan)) {
    digest.add(digest_of_file(file));
  }
  return digest.hex();
}

}  // namespace tactree::cli
