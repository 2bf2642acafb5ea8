#include "image/model_signature.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sodium.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "tactree/core/link/wire/messages.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

constexpr const char* kSecretMark = "tactree secret key ";
constexpr const char* kPublicMark = "tactree public key ";

void prepare_sodium() {
  if (sodium_init() < 0) {
    throw support::UserError(
        "libsodium cannot be initialised (check the source of random numbers, /dev/urandom)");
  }
}

/// Returns false if the text is not hexadecimal or not of this length.
bool from_hex(const std::string& text, std::span<std::uint8_t> bytes) {
  std::size_t length = 0;
  return text.size() == 2U * bytes.size() &&
         sodium_hex2bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &length,
                        nullptr) == 0 &&
         length == bytes.size();
}

std::array<std::uint8_t, 32> read_key(const std::filesystem::path& file, const std::string& mark,
                                      const char* remedy) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::array<std::uint8_t, 32> key{};
  if (!line.starts_with(mark) || !from_hex(line.substr(mark.size()), key)) {
    throw support::UserError(fmt::format("{}: line 1: not a {}({})", file.string(), mark, remedy));
  }
  return key;
}

std::filesystem::path with_suffix(std::filesystem::path path, const char* suffix) {
  path += suffix;
  return path;
}

/// A header with the public key of `file`, for firmware.
std::string header_of(const PublicKey& key, const std::filesystem::path& file) {
  std::string bytes;
  for (std::size_t i = 0; i < key.size(); ++i) {
    bytes += fmt::format("{}0x{:02x},", i % 8 == 0 ? "\n    " : " ", key[i]);
  }
  return fmt::format(
      "// {}, a public key of `tactree keygen`: a board whose kModelKey it is accepts only models "
      "signed\n// with the secret key.\n\n"
      "#pragma once\n\n"
      "#include <cstdint>\n\n"
      "inline constexpr std::uint8_t kPublicKey[{}] = {{{}\n}};\n",
      file.filename().string(), key.size(), bytes);
}

[[noreturn]] void refuse_key_file(const std::filesystem::path& file, int error) {
  throw support::UserError(
      fmt::format("{}: {} (choose another name: a lost key cannot be restored)", file.string(),
                  std::strerror(error)));
}

void write_new_file(const std::filesystem::path& file, const std::string& text, mode_t mode) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) {
    refuse_key_file(file, errno);
  }
  const bool written =
      ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (::close(descriptor) != 0 || !written) {
    throw support::UserError(fmt::format("{}: {}", file.string(), std::strerror(errno)));
  }
}

/// The signed bytes: manifest and model.
std::vector<std::uint8_t> message_of(std::span<const std::byte> blob, const std::string& board,
                                     std::uint32_t counter) {
  core::wire::ModelManifest manifest;
  if (board.size() >= sizeof manifest.board) {
    throw support::UserError(fmt::format("--board: '{}' is longer than {} characters", board,
                                         sizeof manifest.board - 1));
  }
  std::memcpy(manifest.board, board.data(), board.size());
  manifest.counter = counter;
  manifest.bytes = static_cast<std::uint32_t>(blob.size());
  std::vector<std::uint8_t> message(sizeof manifest + blob.size());
  std::memcpy(message.data(), &manifest, sizeof manifest);
  std::memcpy(message.data() + sizeof manifest, blob.data(), blob.size());
  return message;
}

}  // namespace

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += fmt::format("{:02x}", byte);
  }
  return text;
}

std::string describe(const ModelSignature& signature) {
  return fmt::format("for {}, counter {}, by {}",
                     signature.board.empty() ? "any board" : "the board " + signature.board,
                     signature.counter, to_hex(signature.key));
}

PublicKey generate_key(const std::filesystem::path& file) {
  const std::filesystem::path public_file = with_suffix(file, ".pub");
  const std::filesystem::path header_file = with_suffix(file, ".hpp");
  for (const auto& path : {file, public_file, header_file}) {
    if (std::filesystem::exists(path)) {
      refuse_key_file(path, EEXIST);
    }
  }
  prepare_sodium();
  SecretKey seed{};
  randombytes_buf(seed.data(), seed.size());
  PublicKey key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> expanded{};
  crypto_sign_seed_keypair(key.data(), expanded.data(), seed.data());
  write_new_file(file, kSecretMark + to_hex(seed) + "\n", 0600);
  write_new_file(public_file, kPublicMark + to_hex(key) + "\n", 0644);
  write_new_file(header_file, header_of(key, public_file), 0644);
  sodium_memzero(expanded.data(), expanded.size());
  sodium_memzero(seed.data(), seed.size());
  return key;
}

PublicKey read_public_key(const std::filesystem::path& file) {
  return read_key(file, kPublicMark, "tactree keygen makes one, in a file that ends in .pub");
}

SecretKey read_secret_key(const std::filesystem::path& file) {
  return read_key(file, kSecretMark, "tactree keygen makes one");
}

ModelSignature sign_model(const SecretKey& secret, std::span<const std::byte> blob,
                          const std::string& board, std::uint32_t counter) {
  prepare_sodium();
  ModelSignature result;
  result.board = board;
  result.counter = counter;
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> expanded{};
  crypto_sign_seed_keypair(result.key.data(), expanded.data(), secret.data());
  const std::vector<std::uint8_t> message = message_of(blob, board, counter);
  crypto_sign_detached(result.signature.data(), nullptr, message.data(), message.size(),
                       expanded.data());
  sodium_memzero(expanded.data(), expanded.size());
  return result;
}

bool is_valid(const ModelSignature& signature, std::span<const std::byte> blob) {
  prepare_sodium();
  const std::vector<std::uint8_t> message = message_of(blob, signature.board, signature.counter);
  return crypto_sign_verify_detached(signature.signature.data(), message.data(), message.size(),
                                     signature.key.data()) == 0;
}

std::filesystem::path signature_path(const std::filesystem::path& blob) {
  return with_suffix(blob, ".sig");
}

void write_signature(const std::filesystem::path& blob, const ModelSignature& signature,
                     std::size_t blob_bytes) {
  const nlohmann::json json{{"board", signature.board},
                            {"counter", signature.counter},
                            {"bytes", blob_bytes},
                            {"key", to_hex(signature.key)},
                            {"signature", to_hex(signature.signature)}};
  support::write_file(signature_path(blob), json.dump(2) + "\n");
}

std::optional<ModelSignature> read_signature(const std::filesystem::path& blob) {
  const std::filesystem::path path = signature_path(blob);
  if (!std::filesystem::exists(path)) {
    return std::nullopt;
  }
  std::ifstream in(path);
  ModelSignature signature;
  try {
    const nlohmann::json json = nlohmann::json::parse(in);
    signature.board = json.at("board").get<std::string>();
    signature.counter = json.at("counter").get<std::uint32_t>();
    if (from_hex(json.at("key").get<std::string>(), signature.key) &&
        from_hex(json.at("signature").get<std::string>(), signature.signature)) {
      return signature;
    }
  } catch (const nlohmann::json::exception&) {
    // reported below
  }
  throw support::UserError(fmt::format(
      "{}: not a signature of a model (sign the blob again with tactree sign)", path.string()));
}

}  // namespace tactree::cli
