#include "server/http/body_reader.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <atomic>
#include <functional>
#include <random>
#include <thread>

#include "server/base/descriptor.h"

namespace sheetform::server {
namespace {

/// Decodes a text that comes in pieces of the given size. False when it is refused.
bool decode(const std::string& text, std::size_t piece, std::string& body, bool& done) {
  ChunkDecoder decoder;
  body.clear();
  for (std::size_t at = 0; at < text.size(); at += piece) {
    std::string_view input = std::string_view(text).substr(at, piece);
    if (!decoder.decode(input, body)) return false;
  }
  done = decoder.done();
  return true;
}

TEST(ChunkDecoder, GivesTheSameHoweverItIsCut) {
  const std::string text =
      "4\r\nWiki\r\n5;a=\"b\"\r\npedia\r\nA\r\n in\r\nchunk\r\n0\r\nX: 1\r\nY: 2\r\n\r\n";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    std::string body;
    bool done = false;
    ASSERT_TRUE(decode(text, piece, body, done)) << piece;
    EXPECT_EQ(body, "Wikipedia in\r\nchunk");
    EXPECT_TRUE(done);
  }
}

TEST(ChunkDecoder, EveryTruncationIsIncomplete) {
  const std::string text = "3\r\nabc\r\n0\r\n\r\n";
  for (std::size_t cut = 0; cut < text.size(); ++cut) {
    std::string body;
    bool done = false;
    ASSERT_TRUE(decode(text.substr(0, cut), 1, body, done)) << cut;
    EXPECT_FALSE(done) << cut;
  }
}

TEST(ChunkDecoder, RandomBodiesRoundTrip) {
  std::mt19937 rng(5);
  for (int round = 0; round < 200; ++round) {
    std::string plain, coded;
    for (int chunks = static_cast<int>(rng() % 6); chunks > 0; --chunks) {
      std::string data(1 + rng() % 300, '\0');
      for (char& c : data) c = static_cast<char>(rng());
      char size[16];
      std::snprintf(size, sizeof size, rng() % 2 ? "%zx" : "%zX", data.size());
      coded += std::string(size) + "\r\n" + data + "\r\n";
      plain += data;
    }
    std::string body;
    bool done = false;
    ASSERT_TRUE(decode(coded + "0\r\n\r\n", 1 + rng() % 50, body, done));
    EXPECT_EQ(body, plain);
    EXPECT_TRUE(done);
  }
}

struct Ends {
  Descriptor mine, theirs;
  Ends() {
    int fds[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, fds) != 0) throw std::runtime_error("socketpair");
    mine.reset(fds[0]);
    theirs.reset(fds[1]);
  }
  void send(const std::string& text) const {
    ASSERT_EQ(::send(theirs.get(), text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
  }
};

RequestHead with_length(std::uint64_t length) {
  RequestHead head;
  head.method = "POST";
  head.content_length = length;
  return head;
}

TEST(BodyReader, TakesExactlyItsLength) {
  const Ends ends;
  ends.send("defGET / HTTP/1.1");
  BodyReader body(ends.mine.get(), "abc", with_length(6), {});
  body.set_limit(100);
  EXPECT_EQ(body.read_all(), "abcdef");
  EXPECT_TRUE(body.finished());
}

api::ProblemType refusal(BodyReader& body) {
  try {
    (void)body.read_all();
  } catch (const BodyError& e) {
    return e.type();
  }
  return api::ProblemType::kInternal;
}

TEST(BodyReader, LimitCountsForAnnouncedAndUnannouncedBodies) {
  const Ends ends;
  BodyReader announced(ends.mine.get(), "", with_length(11), {});
  EXPECT_THROW(announced.set_limit(10), BodyError);
  RequestHead chunked;
  chunked.chunked = true;
  ends.send("6\r\nabcdef\r\n6\r\nabcdef\r\n");
  BodyReader unannounced(ends.mine.get(), "", chunked, {});
  unannounced.set_limit(10);
  EXPECT_EQ(refusal(unannounced), api::ProblemType::kPayloadTooLarge);
}

TEST(BodyReader, WhoStopsSendingIsGivenUp) {
  const Ends ends;
  BodyPatience patience;
  patience.stall = std::chrono::seconds(0);
  BodyReader body(ends.mine.get(), "ab", with_length(3), patience);
  body.set_limit(10);
  EXPECT_EQ(refusal(body), api::ProblemType::kRequestTimeout);
}

TEST(BodyReader, WhoHangsUpIsMalformed) {
  Ends ends;
  ends.theirs.reset();
  BodyReader body(ends.mine.get(), "ab", with_length(3), {});
  body.set_limit(10);
  EXPECT_EQ(refusal(body), api::ProblemType::kMalformedRequest);
}

TEST(BodyReader, AsksToGoOnOnlyWhenItReads) {
  const Ends ends;
  RequestHead head = with_length(3);
  head.expects_continue = true;
  BodyReader body(ends.mine.get(), "", head, {});
  char buffer[64];
  EXPECT_LT(::recv(ends.theirs.get(), buffer, sizeof buffer, MSG_DONTWAIT), 0);
  ends.send("abc");
  body.set_limit(10);
  EXPECT_EQ(body.read_all(), "abc");
  EXPECT_GT(::recv(ends.theirs.get(), buffer, sizeof buffer, MSG_DONTWAIT), 0);
}

/// Someone at the other end who does something small again and again, until it fails or the test ends.
class Dripper {
 public:
  explicit Dripper(std::function<bool()> step)
      : thread_([this, step = std::move(step)] {
          while (!ending_ && step()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }) {}
  ~Dripper() {
    ending_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

/// Asks for the speed after one second.
BodyPatience patience_for(std::uint64_t bytes_per_second) {
  BodyPatience patience;
  patience.grace = std::chrono::seconds(1);
  patience.bytes_per_second = bytes_per_second;
  return patience;
}

TEST(BodyReader, WhoSendsTooSlowlyIsGivenUp) {
  const Ends ends;
  const Dripper sender(
      [&] { return ::send(ends.theirs.get(), "0123456789", 10, MSG_NOSIGNAL | MSG_DONTWAIT) > 0; });
  BodyReader slow(ends.mine.get(), "", with_length(1'000'000), patience_for(100'000));
  slow.set_limit(1'000'000);
  EXPECT_EQ(refusal(slow), api::ProblemType::kRequestTimeout);
  EXPECT_GT(slow.bytes(), 0u);
  BodyReader fair(ends.mine.get(), "", with_length(1500), patience_for(10));  // takes longer than the grace
  fair.set_limit(1'000'000);
  EXPECT_EQ(fair.read_all().size(), 1500u);
}

TEST(SendAll, WhoReadsTooSlowlyIsGivenUp) {
  const Ends ends;
  const std::string data(2'500'000, 'x');
  const Dripper reader([&] {
    std::string room(10'000, '\0');
    (void)::recv(ends.theirs.get(), room.data(), room.size(), MSG_DONTWAIT);
    return true;
  });
  EXPECT_FALSE(send_all(ends.mine.get(), data, patience_for(50'000'000)));
  EXPECT_TRUE(send_all(ends.mine.get(), data, patience_for(10'000)));
}

TEST(SendAll, WhoStopsReadingIsGivenUp) {
  const Ends ends;
  BodyPatience patience;
  patience.send_stall = std::chrono::seconds(1);
  const auto begun = SteadyClock::now();
  EXPECT_FALSE(send_all(ends.mine.get(), std::string(10'000'000, 'x'), patience));
  EXPECT_GE(SteadyClock::now() - begun, std::chrono::seconds(1));
}

}  // namespace
}  // namespace sheetform::server
