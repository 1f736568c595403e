#include "server/http/guard_server.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <future>
#include <stdexcept>
#include <vector>

namespace sheetform::server {
namespace {

constexpr std::chrono::seconds kPatience{30};

Descriptor ask(int port, const std::string& path) {
  Descriptor s(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(s.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  EXPECT_TRUE(write_whole(s.get(), "GET " + path + " HTTP/1.1\r\nHost: a\r\n\r\n"));
  return s;
}

/// Everything until the other side ends.
std::string rest_of(int fd) {
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = ::recv(fd, buffer, sizeof buffer, 0)) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

bool has_ended(int fd) {
  pollfd end{fd, POLLIN, 0};
  return ::poll(&end, 1, 0) > 0;
}

/// A server whose log fails for "/broken", and whose answer for "/held" comes when it is released.
struct Fixture {
  std::promise<void> held, release;
  GuardServer server{GuardOptions{},
                     [this](GuardedRequest& request) {
                       if (request.head.path == "/held") {
                         held.set_value();
                         release.get_future().wait_for(kPatience);
                       }
                       return Answer();
                     },
                     [](const GuardedRequest& request, const Answer&, const Served&) {
                       if (request.head.path == "/broken") throw std::runtime_error("no room for the log");
                     }};
};

TEST(GuardServer, ASocketWhoseAnswerFailedIsNotCutLater) {
  Fixture f;
  const int port = f.server.listen({"127.0.0.1", 0});
  f.server.start();
  {
    const Descriptor broken = ask(port, "/broken");
    EXPECT_EQ(rest_of(broken.get()).rfind("HTTP/1.1 200", 0), 0u);  // and the socket is closed
  }
  std::vector<Descriptor> others;  // one of them has its number now
  for (int i = 0; i < 16; ++i) {
    std::array<int, 2> pair{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()), 0);
    for (const int fd : pair) others.emplace_back(fd);
  }
  const Descriptor held = ask(port, "/held");
  ASSERT_EQ(f.held.get_future().wait_for(kPatience), std::future_status::ready);
  auto drained = std::async(std::launch::async, [&] { return f.server.drain(SteadyClock::now()); });
  EXPECT_EQ(rest_of(held.get()), "");  // cut
  f.release.set_value();
  EXPECT_FALSE(drained.get());
  for (const Descriptor& other : others) EXPECT_FALSE(has_ended(other.get()));
}

}  // namespace
}  // namespace sheetform::server
