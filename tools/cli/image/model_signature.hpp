#pragma once
// Keys and signatures of models. A signed model is a .blob and, beside it, a .blob.sig of JSON:
//   {"board": "...", "counter": 1, "bytes": 123, "key": "<64 hex>", "signature": "<128 hex>"}

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace tactree::cli {

using PublicKey = std::array<std::uint8_t, 32>;
using SecretKey = std::array<std::uint8_t, 32>;  ///< the seed of RFC 8032

struct ModelSignature {
  std::string board;
  std::uint32_t counter = 0;
  PublicKey key{};
  std::array<std::uint8_t, 64> signature{};
};

/// Writes `file`, which only its owner can read, `file`.pub and `file`.hpp, a header for firmware.
/// Throws UserError, also if one of them exists.
PublicKey generate_key(const std::filesystem::path& file);

/// Both throw UserError with the file, the cause and the hint.
[[nodiscard]] PublicKey read_public_key(const std::filesystem::path& file);
[[nodiscard]] SecretKey read_secret_key(const std::filesystem::path& file);

[[nodiscard]] ModelSignature sign_model(const SecretKey& secret, std::span<const std::byte> blob,
                                        const std::string& board, std::uint32_t counter);
[[nodiscard]] bool is_valid(const ModelSignature& signature, std::span<const std::byte> blob);

[[nodiscard]] std::filesystem::path signature_path(const std::filesystem::path& blob);
void write_signature(const std::filesystem::path& blob, const ModelSignature& signature,
                     std::size_t blob_bytes);
/// Reads the signature beside the blob; nullopt if there is no file. Throws UserError if the
/// signature is malformed.
[[nodiscard]] std::optional<ModelSignature> read_signature(const std::filesystem::path& blob);

/// Text such as "for any board, counter 3, by <hex>".
[[nodiscard]] std::string describe(const ModelSignature& signature);

[[nodiscard]] std::string to_hex(std::span<const std::uint8_t> bytes);

}  // namespace tactree::cli
