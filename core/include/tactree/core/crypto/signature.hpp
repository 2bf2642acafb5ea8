#pragma once
// Verification of Ed25519 signatures (RFC 8032, section 5.1.7). A board holds no secret key,
// so constant time is not required.
//
// The verification is strict: it rejects an S that is not below the group order, an R or key that
// is not canonically encoded, and an R or key of small order. Each of these would allow two
// signatures for one message, or one signature for several messages.
//
// Interrupt safety: no shared state, but too slow for an interrupt. RAM: about 2 KiB of stack.
// Cost: about 20 million instructions, plus 40 per byte of the message.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

inline constexpr std::size_t kSignatureBytes = 64;
inline constexpr std::size_t kPublicKeyBytes = 32;
using SignatureView = std::span<const std::uint8_t, kSignatureBytes>;
using PublicKeyView = std::span<const std::uint8_t, kPublicKeyBytes>;

/// True if `signature` is valid for `key` and the message `head` followed by `body`.
[[nodiscard]] bool is_signed_by(PublicKeyView key, SignatureView signature,
                                std::span<const std::byte> head, std::span<const std::byte> body);

}  // namespace tactree::core
