#include "server/http/conditional.h"

#include <gtest/gtest.h>

#include <random>

#include "server/http/zip_writer.h"

namespace sheetform::server {
namespace {

using Kind = RangeChoice::Kind;

/// What RFC 9110, 14.1.2 says, by brute force over the bytes of a short file.
std::string oracle(std::optional<std::uint64_t> first, std::optional<std::uint64_t> last,
                   const std::string& file) {
  std::string chosen;
  for (std::uint64_t i = 0; i < file.size(); ++i) {
    const bool in = first ? i >= *first && (!last || i <= *last) : file.size() - i <= *last;
    if (in) chosen += file[i];
  }
  return chosen;
}

TEST(Range, AgreesWithBruteForce) {
  std::mt19937 rng(1);
  for (int round = 0; round < 20000; ++round) {
    std::string file(rng() % 12, ' ');
    for (std::size_t i = 0; i < file.size(); ++i) file[i] = static_cast<char>('a' + i);
    const auto number = [&]() -> std::uint64_t {
      return rng() % 8 == 0 ? UINT64_MAX - rng() % 3 : rng() % 15;
    };
    std::optional<std::uint64_t> first, last;
    if (rng() % 3) first = number();
    if (!first || rng() % 3) last = number();
    std::string field =
        "bytes=" + (first ? std::to_string(*first) : "") + "-" + (last ? std::to_string(*last) : "");
    const RangeChoice choice = choose_range(field, file.size());
    if (first && last && *last < *first) {
      EXPECT_EQ(choice.kind, Kind::kWhole) << field;
      continue;
    }
    const std::string expected = oracle(first, last, file);
    if (expected.empty()) {
      EXPECT_EQ(choice.kind, Kind::kUnsatisfiable) << field << " of " << file.size();
    } else {
      ASSERT_EQ(choice.kind, Kind::kPart) << field << " of " << file.size();
      ASSERT_LT(choice.range.last, file.size());
      EXPECT_EQ(file.substr(choice.range.first, choice.range.length()), expected) << field;
    }
  }
}

TEST(Range, AnythingElseMeansTheWholeFile) {
  for (const char* field : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=1-2,4-5", "Bytes=0-1",
                            "lines=0-1", "bytes=0x1-2", "bytes=1--2", "bytes= 1 2-3", "bytes=+1-2"})
    EXPECT_EQ(choose_range(field, 10).kind, Kind::kWhole) << field;
}

TEST(Tags, ListsAndWeakness) {
  EXPECT_TRUE(names_tag("\"a\"", "\"a\"", false));
  EXPECT_TRUE(names_tag("\"x\" , W/\"a\"", "\"a\"", true));
  EXPECT_FALSE(names_tag("W/\"a\"", "\"a\"", false));
  EXPECT_TRUE(names_tag(" * ", "\"a\"", false));
  EXPECT_FALSE(names_tag("a", "\"a\"", true));
  EXPECT_FALSE(names_tag("\"a", "\"a\"", true));
  EXPECT_FALSE(names_tag("", "\"a\"", true));
}

TEST(Dates, RoundTrip) {
  EXPECT_EQ(http_date(784111777), "Sun, 06 Nov 1994 08:49:37 GMT");
  EXPECT_EQ(parse_http_date("Sun, 06 Nov 1994 08:49:37 GMT"), 784111777);
  EXPECT_FALSE(parse_http_date("Sunday, 06-Nov-94 08:49:37 GMT"));
  EXPECT_FALSE(parse_http_date("Sun, 06 Nov 1994 08:49:37 GMTx"));
}

TEST(Prefer, Wait) {
  EXPECT_EQ(preferred_wait("wait=10"), 10);
  EXPECT_EQ(preferred_wait("respond-async, wait=5"), 5);
  EXPECT_EQ(preferred_wait("return=minimal,wait=0"), 0);
  for (const char* field :
       {"", "respond-async", "wait", "wait=", "wait=-1", "wait=x", "wait=99999999999999", "await=5"})
    EXPECT_FALSE(preferred_wait(field)) << field;
}

TEST(Zip, CrcKnownAnswer) {
  EXPECT_EQ(crc32_of("123456789"), 0xcbf43926u);
  EXPECT_EQ(crc32_of("6789", crc32_of("12345")), 0xcbf43926u);
}

TEST(Zip, PiecesOfAnySizeGiveTheSameArchive) {
  const std::vector<std::string> contents{"hello", "", std::string(1000, 'z')};
  std::vector<ZipMember> members;
  for (std::size_t i = 0; i < contents.size(); ++i)
    members.push_back(
        {"file" + std::to_string(i), contents[i].size(), crc32_of(contents[i]),
         [&contents, i](std::uint64_t o, std::uint64_t n) { return contents[i].substr(o, n); }});
  const ZipArchive archive(members, 784111777);
  const auto whole = [&](std::uint64_t piece) {
    std::string bytes;
    while (bytes.size() < archive.length()) {
      const std::string next = archive.read(bytes.size(), piece);
      EXPECT_FALSE(next.empty());
      bytes += next;
      if (next.empty()) break;
    }
    return bytes;
  };
  const std::string expected = whole(1 << 20);
  EXPECT_EQ(expected.size(), archive.length());
  EXPECT_EQ(expected.substr(0, 4), "PK\x03\x04");
  for (const std::uint64_t piece : {1u, 7u, 100u}) EXPECT_EQ(whole(piece), expected);
}

}  // namespace
}  // namespace sheetform::server
