#include "device/share_token.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

constexpr std::size_t kMinLetters = 16;
constexpr std::size_t kNewBytes = 16;  // 128 bits

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

bool is_token_letter(char letter) {
  return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
         (letter >= 'A' && letter <= 'Z') || letter == '-' || letter == '_';
}

std::string new_token() {
  if (::sodium_init() < 0) {
    throw support::UserError("no random numbers for a token (give a --token-file)");
  }
  std::array<unsigned char, kNewBytes> bytes{};
  ::randombytes_buf(bytes.data(), bytes.size());
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

}  // namespace

std::string share_token(const std::string& file, const std::string& address) {
  if (file.empty()) {
    return is_loopback(address) ? "" : new_token();
  }
  std::ifstream text(file);
  std::string token;
  if (!std::getline(text, token) || token.size() < kMinLetters ||
      !std::all_of(token.begin(), token.end(), is_token_letter)) {
    throw support::UserError(fmt::format(
        "{}: no token (write a line of at least {} letters, digits, - and _)", file, kMinLetters));
  }
  return token;
}

}  // namespace tactree::cli
