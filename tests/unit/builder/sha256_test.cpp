#include "sha256.hpp"

#include <gtest/gtest.h>

#include <string>

namespace tactree::builder {
namespace {

std::string hash(const std::string& text) {
  Sha256 sha;
  sha.update(std::as_bytes(std::span(text)));
  return to_hex(sha.digest());
}

TEST(Sha256, AgreesWithTheStandardsExamples) {
  EXPECT_EQ(hash(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnThePieces) {
  std::string text;
  for (int i = 0; i < 300; ++i) {
    text += static_cast<char>(i);
  }
  for (std::size_t length = 0; length <= text.size(); ++length) {  // every padding
    const std::string whole = text.substr(0, length);
    Sha256 sha;
    for (std::size_t i = 0; i < length; i += 7) {
      sha.update(std::as_bytes(std::span(whole).subspan(i, std::min<std::size_t>(7, length - i))));
    }
    ASSERT_EQ(to_hex(sha.digest()), hash(whole)) << length;
  }
}

}  // namespace
}  // namespace tactree::builder
