// Accepts connections and waits for complete request heads in one thread, so that idle and slow clients cost
// a socket and a few bytes, never a thread.
#pragma once
#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/descriptor.h"

struct sockaddr_storage;

namespace sheetform::server {

/// A connection whose first bytes have come.
struct Arrival {
  enum class Kind { kHead, kTooLarge, kTooSlow, kNotHttp };
  Kind kind = Kind::kHead;
  Descriptor socket;  ///< blocking again
  std::string peer;   ///< address of the other side
  std::string bytes;  ///< the head, and whatever came with it
  std::size_t head_end = 0;
};

struct GateLimits {
  /// Connections without a complete head. When there are more, the oldest of the network that has most goes.
  std::size_t waiting = 2048;
  std::chrono::seconds head_time{10};
};

struct ListenAddress {
  std::string host;
  int port = 0;
  bool loopback() const;
  std::string text() const;
};
/// Reads "127.0.0.1:8080", "[::1]:8080", "localhost:8080". False when it is none.
bool parse_address(const std::string& text, ListenAddress& address);

class ConnectionGate {
 public:
  /// arrived: called on the gate's thread; must not block. False sheds the connection (it is told to come
  /// back).
  ConnectionGate(GateLimits limits, std::function<bool(Arrival&)> arrived);
  ~ConnectionGate();
  ConnectionGate(const ConnectionGate&) = delete;
  ConnectionGate& operator=(const ConnectionGate&) = delete;

  /// Opens one more listening socket; the port that it got (for port 0). Throws std::system_error.
  int listen(const ListenAddress& address);
  /// Serves until stop() was called from any thread.
  void run();
  void stop();

  int waiting() const { return waiting_count_; }
  std::uint64_t shed() const { return shed_; }
  /// When the loop came around the last time; for the health check.
  SteadyClock::time_point last_turn() const {
    return SteadyClock::time_point(SteadyClock::duration(last_turn_.load()));
  }

 private:
  /// How many wait, by network: an IPv4 address, or the /64 of an IPv6 one, which is what one client may
  /// have.
  using Networks = std::map<std::uint64_t, int>;
  struct Waiting {
    Descriptor socket;
    std::string peer, bytes;
    SteadyClock::time_point deadline;
    Networks::iterator network;
  };
  using WaitingMap = std::map<int, Waiting>;
  void accept_all(int listener);
  void make_room();
  void take(Descriptor socket, const sockaddr_storage& peer);
  void forget(WaitingMap::iterator waiting);
  void read_from(int fd);
  void hand_over(int fd, Arrival::Kind kind, std::size_t head_end);
  void shed_one(Descriptor socket);
  void drop_late();
  void drop_oldest();

  GateLimits limits_;
  std::function<bool(Arrival&)> arrived_;
  Descriptor epoll_, wake_;
  std::vector<Descriptor> listeners_;
  Networks networks_;
  WaitingMap waiting_;
  std::atomic<int> waiting_count_{0};
  std::atomic<std::uint64_t> shed_{0};
  std::atomic<bool> stopping_{false};
  std::atomic<SteadyClock::duration::rep> last_turn_{SteadyClock::now().time_since_epoch().count()};
};

}  // namespace sheetform::server
