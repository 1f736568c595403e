// The table of tests/server_process/test_http.py goes through a socket; here is what needs a look inside.
#include "server/http/request_head.h"

#include <gtest/gtest.h>

#include "server/http/router.h"

namespace sheetform::server {
namespace {

RequestHead parsed(const std::string& text) {
  RequestHead head;
  HeadError error;
  EXPECT_TRUE(parse_request_head(text, head, error)) << error.detail << "\n" << text;
  return head;
}

TEST(RequestHead, TakesApart) {
  const RequestHead h = parsed(
      "POST /a%20b/c?x=1&y=%2F HTTP/1.1\r\nHost: h:1\r\nX-A:  one \r\nx-a:two\r\nContent-Length: 12\r\n\r\n");
  EXPECT_EQ(h.method, "POST");
  EXPECT_EQ(h.path, "/a b/c");
  EXPECT_EQ(h.query, "x=1&y=%2F");
  EXPECT_EQ(h.field("x-a"), "one, two");
  EXPECT_EQ(h.content_length, 12u);
  EXPECT_TRUE(h.has_body());
  EXPECT_FALSE(h.chunked);
}

TEST(RequestHead, FindsItsEndWhereverTheSearchBegan) {
  const std::string text = "GET / HTTP/1.1\r\nHost: a\r\n\r\nrest";
  const std::size_t end = text.size() - 4;
  for (std::size_t from = 0; from <= end; ++from)
    EXPECT_EQ(find_head_end(text, from), from <= end - 1 ? end : std::string::npos) << from;
}

TEST(RequestHead, EveryTruncationIsRefused) {
  const std::string text =
      "POST /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\nExpect: 100-continue\r\n\r\n";
  for (std::size_t cut = 0; cut < text.size(); ++cut) {
    RequestHead head;
    HeadError error;
    EXPECT_FALSE(parse_request_head(text.substr(0, cut), head, error)) << cut;
  }
  EXPECT_TRUE(parsed(text).expects_continue);
}

TEST(RequestHead, PercentDecoding) {
  std::string out;
  EXPECT_TRUE(percent_decode("a%41+b", false, out));
  EXPECT_EQ(out, "aA+b");
  EXPECT_TRUE(percent_decode("a%41+b%2b", true, out));
  EXPECT_EQ(out, "aA b+");
  for (const char* text : {"%", "%4", "%4g", "%%41", "a%"})
    EXPECT_FALSE(percent_decode(text, true, out)) << text;
}

TEST(RequestHead, Queries) {
  Query query;
  ASSERT_TRUE(parse_query("a=1&&b=&c&d=x=y&e=%26", query));
  EXPECT_EQ(query, (Query{{"a", "1"}, {"b", ""}, {"c", ""}, {"d", "x=y"}, {"e", "&"}}));
  EXPECT_FALSE(parse_query("a=%0a", query));
  EXPECT_FALSE(parse_query("%00=1", query));
}

TEST(Router, MatchesWholeSegments) {
  Router router;
  const auto nothing = [](Exchange&) { return Answer{}; };
  router.add({"GET", "/a", "", nothing});
  router.add({"GET", "/a/{x}", "", nothing});
  router.add({"DELETE", "/a/{x}", "", nothing});
  router.add({"POST", "/a/{x}/b/{y}", "", nothing});
  EXPECT_EQ(router.match("GET", "/a").route, &router.routes()[0]);
  EXPECT_EQ(router.match("HEAD", "/a/7").route, &router.routes()[1]);
  EXPECT_EQ(router.match("DELETE", "/a/7").captures, std::vector<std::string>{"7"});
  EXPECT_EQ(router.match("POST", "/a/1/b/2").captures, (std::vector<std::string>{"1", "2"}));
  for (const char* path : {"/", "/a/", "/a/1/", "/a/1/b", "/a/1/c/2", "/ab", "/a/1/b/2/c"})
    EXPECT_EQ(router.match("POST", path).route, nullptr) << path;
  EXPECT_EQ(router.match("PUT", "/a/7").allowed, "GET, HEAD, DELETE");
  EXPECT_EQ(router.match("PUT", "/b").allowed, "");
}

}  // namespace
}  // namespace sheetform::server
