#include "source_digest.hpp"

#include <sodium/core.h>
#include <sodium/crypto_hash_sha256.h>

#include <fstream>
#include <stdexcept>
#include <vector>

namespace tactree::builder {
namespace {

static_assert(std::tuple_size_v<Sha256Digest> == crypto_hash_sha256_BYTES);

Sha256Digest digest_of(std::span<const std::filesystem::path> files,
                       const std::atomic<bool>& stop) {
  if (::sodium_init() < 0) {
    throw std::runtime_error("libsodium cannot be initialised (check the installation)");
  }
  crypto_hash_sha256_state state;
  ::crypto_hash_sha256_init(&state);
  std::vector<char> buffer(1 << 20);
  for (const std::filesystem::path& file : files) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      continue;
    }
    std::ifstream in(file, std::ios::binary);
    while (!stop && (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) ||
                     in.gcount() > 0)) {
      ::crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(buffer.data()),
                                  static_cast<unsigned long long>(in.gcount()));
    }
  }
  Sha256Digest digest{};
  ::crypto_hash_sha256_final(&state, digest.data());
  return digest;
}

}  // namespace

SourceDigest::SourceDigest(std::span<const std::filesystem::path> files, bool in_background)
    : digest_(std::async(in_background ? std::launch::async : std::launch::deferred,
                         [files, this] { return digest_of(files, stop_); })) {}

SourceDigest::~SourceDigest() { stop_ = true; }

}  // namespace tactree::builder
