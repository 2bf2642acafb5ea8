#include "tactree/support/uri.hpp"

#include <gtest/gtest.h>

namespace tactree::support {
namespace {

TEST(Uri, EncodesAllButPlainCharacters) {
  EXPECT_EQ(encoded_uri("a b/\xc3\xa9%\"<.ply"), "a%20b/%C3%A9%25%22%3C.ply");
  EXPECT_EQ(encoded_uri("A-z_0.9~/b"), "A-z_0.9~/b");
}

TEST(Uri, DecodesWhatItEncodes) {
  std::string all;
  for (int c = 1; c < 256; ++c) {
    all.push_back(static_cast<char>(c));
  }
  EXPECT_EQ(decoded_uri(encoded_uri(all)), all);
  EXPECT_EQ(decoded_uri("a%2eB%2E"), "a.B.");
}

TEST(Uri, KeepsIncompleteEscapes) {
  for (const char* text : {"%", "100%", "%2", "%2g", "%%", "a%zzb"}) {
    EXPECT_EQ(decoded_uri(text), text);
  }
}

}  // namespace
}  // namespace tactree::support
