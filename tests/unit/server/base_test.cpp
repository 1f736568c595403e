#include <gtest/gtest.h>

#include <set>

#include "server/base/digest.h"
#include "server/base/identity.h"

namespace sheetform::server {
namespace {

TEST(Identity, UuidsAreUniqueSortedAndWellFormed) {
  std::set<std::string> seen;
  std::string before;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = make_uuid();
    EXPECT_TRUE(is_uuid(id)) << id;
    EXPECT_EQ(id[14], '7');
    EXPECT_TRUE(seen.insert(id).second);
    EXPECT_GE(id.substr(0, 13), before);  // the part that is the time never goes back
    before = id.substr(0, 13);
  }
  for (const char* text :
       {"", "x", "0193A0B0-0000-7000-8000-000000000000", "0193a0b0-0000-7000-8000-00000000000",
        "0193a0b0-0000-7000-8000-0000000000000", "0193a0b0_0000-7000-8000-000000000000"})
    EXPECT_FALSE(is_uuid(text)) << text;
}

TEST(Identity, HexRoundTrips) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  std::string back;
  ASSERT_TRUE(from_hex(to_hex(bytes), back));
  EXPECT_EQ(back, bytes);
  EXPECT_FALSE(from_hex("abc", back));
  EXPECT_FALSE(from_hex("zz", back));
}

// Known answers of FIPS 180-4.
TEST(Digest, Sha256KnownAnswers) {
  EXPECT_EQ(to_hex(sha256("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(to_hex(sha256("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 hash;
  hash.add("a");
  hash.add("");
  hash.add("bc");
  EXPECT_EQ(hash.finish(), sha256("abc"));
}

// Known answers of RFC 4648.
TEST(Digest, Base64KnownAnswers) {
  const char* pairs[][2] = {{"", ""},
                            {"f", "Zg=="},
                            {"fo", "Zm8="},
                            {"foo", "Zm9v"},
                            {"foob", "Zm9vYg=="},
                            {"fooba", "Zm9vYmE="},
                            {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : pairs) {
    std::string back;
    EXPECT_EQ(to_base64(plain), coded);
    ASSERT_TRUE(from_base64(coded, back)) << coded;
    EXPECT_EQ(back, plain);
  }
}

TEST(Digest, WrongBase64IsRefused) {
  std::string bytes;
  for (const char* text :
       {"Z", "Zg", "Zg=", "Zg===", "Z===", "====", "Zh==", "Zm9=", "Zm9v\n", "Zm 9v", "Zg==Zg==", "Zm9_"})
    EXPECT_FALSE(from_base64(text, bytes)) << text;
}

TEST(Digest, ConstantTimeComparison) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  EXPECT_FALSE(equal_in_constant_time("abc", "abd"));
  EXPECT_FALSE(equal_in_constant_time("abc", "ab"));
}

}  // namespace
}  // namespace sheetform::server
