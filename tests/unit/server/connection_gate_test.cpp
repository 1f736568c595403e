#include "server/http/connection_gate.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <cerrno>
#include <deque>
#include <mutex>
#include <thread>

namespace {

/// What the next calls of accept4 answer, and how often it was called.
struct Accepting {
  std::mutex mutex;
  std::deque<int> errors;
  int standing = 0;  ///< the error of all further calls; 0: none
  int calls = 0;
};
Accepting& accepting() {
  static Accepting a;
  return a;
}

int next_error() {
  Accepting& a = accepting();
  const std::lock_guard lock(a.mutex);
  ++a.calls;
  if (a.errors.empty()) return a.standing;
  const int error = a.errors.front();
  a.errors.pop_front();
  return error;
}

}  // namespace

/// Stands in for that of the C library in the whole program.
extern "C" int accept4(int fd, sockaddr* address, socklen_t* size, int flags) {
  if (const int error = next_error(); error != 0) {
    errno = error;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_accept4, fd, address, size, flags));
}

namespace sheetform::server {
namespace {

using std::chrono::milliseconds;

/// Whether there is something to read, or the other side has hung up, within the time.
bool becomes_ready(int fd, milliseconds time) {
  pollfd end{fd, POLLIN, 0};
  return ::poll(&end, 1, static_cast<int>(time.count())) > 0;
}

/// A gate that runs, and the arrivals that it handed over.
class RunningGate {
 public:
  explicit RunningGate(GateLimits limits = {})
      : gate_(limits,
              [this](Arrival& arrival) {
                const std::lock_guard lock(mutex_);
                arrivals_.push_back(std::move(arrival));
                return true;
              }),
        port_(gate_.listen({"127.0.0.1", 0})) {
    const std::lock_guard lock(accepting().mutex);
    accepting().errors.clear();
    accepting().standing = 0;
    thread_ = std::thread([this] { gate_.run(); });
  }
  ~RunningGate() {
    gate_.stop();
    thread_.join();
  }

  Descriptor connect(const std::string& text = {}, std::uint32_t from = INADDR_LOOPBACK) const {
    Descriptor s(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in own{}, to{};
    own.sin_family = to.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(from);
    to.sin_port = htons(static_cast<std::uint16_t>(port_));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(s.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    EXPECT_EQ(::connect(s.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
    EXPECT_TRUE(write_whole(s.get(), text));
    return s;
  }
  bool until_waiting(int count) const {
    return until([&] { return gate_.waiting() == count; });
  }
  bool until_arrived(std::size_t count) {
    return until([&] {
      const std::lock_guard lock(mutex_);
      return arrivals_.size() == count;
    });
  }
  Arrival& first() { return arrivals_.at(0); }
  std::uint64_t shed() const { return gate_.shed(); }

 private:
  template <class Good>
  static bool until(Good&& good) {
    const auto end = SteadyClock::now() + std::chrono::seconds(10);
    while (!good() && SteadyClock::now() < end) std::this_thread::sleep_for(milliseconds(1));
    return good();
  }

  std::mutex mutex_;
  std::vector<Arrival> arrivals_;
  ConnectionGate gate_;
  int port_;
  std::thread thread_;
};

constexpr const char* kRequest = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";

void set_errors(std::deque<int> errors, int standing = 0) {
  const std::lock_guard lock(accepting().mutex);
  accepting().errors = std::move(errors);
  accepting().standing = standing;
  accepting().calls = 0;
}

int calls() {
  const std::lock_guard lock(accepting().mutex);
  return accepting().calls;
}

TEST(ConnectionGate, ErrorsOfOneConnectionStopNothing) {
  RunningGate gate;
  set_errors({ECONNABORTED, EPROTO, EINTR, EPERM, ENETDOWN, EHOSTUNREACH, ECONNABORTED});
  const Descriptor client = gate.connect(kRequest);
  ASSERT_TRUE(gate.until_arrived(1));
  EXPECT_EQ(gate.first().bytes, kRequest);
}

TEST(ConnectionGate, WithoutDescriptorsItNeitherSpinsNorForgets) {
  for (const int shortage : {EMFILE, ENFILE, ENOBUFS, ENOMEM}) {
    RunningGate gate;
    set_errors({}, shortage);
    const Descriptor client = gate.connect(kRequest);
    EXPECT_FALSE(becomes_ready(client.get(), milliseconds(500)));
    EXPECT_GT(calls(), 1) << shortage;
    EXPECT_LT(calls(), 50) << shortage;
    set_errors({});
    EXPECT_TRUE(gate.until_arrived(1)) << shortage;
  }
}

TEST(ConnectionGate, AnIdleConnectionMakesRoomForANewOne) {
  RunningGate gate;
  const Descriptor first = gate.connect();
  ASSERT_TRUE(gate.until_waiting(1));
  const Descriptor second = gate.connect();
  ASSERT_TRUE(gate.until_waiting(2));
  set_errors({EMFILE});
  const Descriptor client = gate.connect(kRequest);
  ASSERT_TRUE(gate.until_arrived(1));
  EXPECT_TRUE(becomes_ready(first.get(), std::chrono::seconds(10)));
  EXPECT_FALSE(becomes_ready(second.get(), milliseconds(50)));
  EXPECT_EQ(gate.shed(), 1u);
}

TEST(ConnectionGate, TheOldestGoWhenTooManyWait) {
  GateLimits limits;
  limits.waiting = 3;
  RunningGate gate(limits);
  std::vector<Descriptor> idle;
  for (int i = 0; i < 5; ++i) {
    idle.push_back(gate.connect("GET"));
    ASSERT_TRUE(gate.until_waiting(std::min(i + 1, 3)));
  }
  for (const int gone : {0, 1})
    EXPECT_TRUE(becomes_ready(idle[static_cast<std::size_t>(gone)].get(), std::chrono::seconds(10)));
  for (const int kept : {2, 3, 4})
    EXPECT_FALSE(becomes_ready(idle[static_cast<std::size_t>(kept)].get(), milliseconds(20)));
  EXPECT_EQ(gate.shed(), 2u);
  EXPECT_TRUE(write_whole(idle[2].get(), std::string(kRequest).substr(3)));
  EXPECT_TRUE(gate.until_arrived(1));
}

TEST(ConnectionGate, WhoHoldsMostMakesRoom) {
  GateLimits limits;
  limits.waiting = 6;
  RunningGate gate(limits);
  const std::uint32_t others = INADDR_LOOPBACK + 1;
  const Descriptor oldest = gate.connect("GET", others);
  ASSERT_TRUE(gate.until_waiting(1));
  std::vector<Descriptor> greedy;
  for (int i = 0; i < 10; ++i) {
    greedy.push_back(gate.connect("GET"));
    ASSERT_TRUE(gate.until_waiting(std::min(i + 2, 6)));
  }
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(becomes_ready(greedy[i].get(), std::chrono::seconds(10)));
  EXPECT_EQ(gate.shed(), 5u);
  const Descriptor newest = gate.connect("GET", others);
  EXPECT_TRUE(becomes_ready(greedy[5].get(), std::chrono::seconds(10)));
  for (const Descriptor* kept : {&oldest, &newest}) {
    EXPECT_FALSE(becomes_ready(kept->get(), milliseconds(20)));
    EXPECT_TRUE(write_whole(kept->get(), std::string(kRequest).substr(3)));
  }
  EXPECT_TRUE(gate.until_arrived(2));
}

TEST(ConnectionGate, ConnectionsStayOutOfChildren) {
  RunningGate gate;
  const Descriptor client = gate.connect(kRequest);
  ASSERT_TRUE(gate.until_arrived(1));
  EXPECT_NE(::fcntl(gate.first().socket.get(), F_GETFD) & FD_CLOEXEC, 0);
}

}  // namespace
}  // namespace sheetform::server
