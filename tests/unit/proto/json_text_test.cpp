#include "sheetform_api/json_text.h"

#include <gtest/gtest.h>

namespace sheetform::api {
namespace {

bool parses(const std::string& text) {
  Json value;
  std::string why;
  const bool good = parse_json(text, value, why);
  EXPECT_EQ(good, why.empty());
  return good;
}

TEST(JsonText, ReadsWhatIsJson) {
  EXPECT_TRUE(parses(R"({"a":[1,2,{"b":null}]})"));
  EXPECT_TRUE(parses(R"({"a":{"x":1},"b":{"x":1}})"));
  EXPECT_TRUE(parses(R"("a } in a text, and \" too")"));
}

TEST(JsonText, RefusesWhatIsNot) {
  for (const char* text : {"", "{", "nul", "{\"a\":1,}", "[1] x", "{\"a\":1 \"b\":2}", "\"\xff\"", "'a'"})
    EXPECT_FALSE(parses(text)) << text;
}

TEST(JsonText, RefusesDuplicateMembersAtAnyDepth) {
  EXPECT_FALSE(parses(R"({"a":1,"a":2})"));
  EXPECT_FALSE(parses(R"([{"b":{"a":1,"c":0,"a":2}}])"));
}

TEST(JsonText, RefusesDeepNesting) {
  const auto nested = [](std::size_t n) { return std::string(n, '[') + std::string(n, ']'); };
  EXPECT_TRUE(parses(nested(kJsonDepth)));
  EXPECT_FALSE(parses(nested(kJsonDepth + 1)));
  EXPECT_FALSE(parses(std::string(1000000, '[')));
}

TEST(JsonText, WritingNeverThrows) { EXPECT_EQ(dump(Json("a\xff")), "\"a\xEF\xBF\xBD\""); }

TEST(JsonText, TimesRoundTrip) {
  EXPECT_EQ(rfc3339(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(rfc3339(-1000), "1969-12-31T23:59:59.999Z");
  std::int64_t at = 0;
  for (const std::int64_t t :
       {std::int64_t{0}, std::int64_t{1795339440123000}, std::int64_t{951782400000000}}) {
    ASSERT_TRUE(parse_rfc3339(rfc3339(t), at));
    EXPECT_EQ(at, t);
  }
  ASSERT_TRUE(parse_rfc3339("2026-11-22T10:00:00+01:00", at));
  EXPECT_EQ(rfc3339(at), "2026-11-22T09:00:00.000Z");
}

TEST(JsonText, OtherTimesAreRefused) {
  std::int64_t at = 0;
  for (const char* text :
       {"", "2026-11-22", "2026-13-22T10:00:00Z", "2026-11-22T24:00:00Z", "2026-11-22T10:00:00",
        "2026-11-22T10:00:00.Z", "2026-11-22T10:00:00Zx", "-026-11-22T10:00:00Z"})
    EXPECT_FALSE(parse_rfc3339(text, at)) << text;
}

}  // namespace
}  // namespace sheetform::api
