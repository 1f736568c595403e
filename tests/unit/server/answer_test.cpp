#include "server/http/answer.h"

#include <gtest/gtest.h>

namespace sheetform::server {
namespace {

// A line break in a value would end the header, and what follows be one of its own (CVE-2023-26130).
TEST(Answer, ValuesOfHeadersCannotBecomeHeaders) {
  Answer answer;
  answer.with("X-Name", std::string("a\r\nSet-Cookie: b\0c\td\x7f", 21));
  ASSERT_EQ(answer.headers.size(), 1u);
  EXPECT_EQ(answer.headers[0].first, "X-Name");
  EXPECT_EQ(answer.headers[0].second, "a  Set-Cookie: b c d ");
  EXPECT_TRUE(answer.has("X-Name"));
  EXPECT_FALSE(answer.has("Set-Cookie"));
}

TEST(Answer, OtherLettersStayAsTheyAre) {
  Answer answer;
  answer.with("Content-Disposition", "attachment; filename*=UTF-8''%C3%A4; filename=\"\xc3\xa4\"");
  EXPECT_EQ(answer.headers[0].second, "attachment; filename*=UTF-8''%C3%A4; filename=\"\xc3\xa4\"");
}

}  // namespace
}  // namespace sheetform::server
