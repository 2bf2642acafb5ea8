#pragma once
// Ed25519: was this signed by the owner of the key? (RFC 8032, sections 5.1 and 6.) Verifying only:
// a board keeps no secret, so nothing here has to run in constant time.
//
// Strict: a signature whose S is not below the group's order, whose R or key is not a canonical
// point, or whose key or R is of small order, is refused. Each of these would let one message have
// two signatures, or one signature fit many messages.
//
// Interrupt safe: no shared state. RAM: about 2 KiB of stack. Cost: about 20 million instructions,
// and 40 a byte of the message.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

inline constexpr std::size_t kSignatureBytes = 64;
inline constexpr std::size_t kPublicKeyBytes = 32;
using SignatureView = std::span<const std::uint8_t, kSignatureBytes>;
using PublicKeyView = std::span<const std::uint8_t, kPublicKeyBytes>;

/// The message is `head` followed by `body`.
[[nodiscard]] bool is_signed_by(PublicKeyView key, SignatureView signature,
                                std::span<const std::byte> head, std::span<const std::byte> body);

}  // namespace tactree::core
