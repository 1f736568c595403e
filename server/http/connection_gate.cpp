#include "server/http/connection_gate.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <memory>
#include <system_error>
#include <thread>

#include "server/http/request_head.h"

namespace sheetform::server {
namespace {

constexpr int kBacklog = 1024;
constexpr int kTickMilliseconds = 500;
/// The system keeps so little unsent for a client that even one at the least speed takes half of it within
/// the patience of BodyPatience: megabytes would hide that a slow client reads, and it would be given up as
/// dead.
constexpr int kUnsentBytes = 64 * 1024;
constexpr auto kShortagePause = std::chrono::milliseconds(50);
constexpr char kTlsHandshake = '\x16';  // the first byte of a connection by https
/// What a connection gets for which there is no thread; made once, for this must be quick.
const std::string& shed_answer() {
  static const std::string whole = [] {
    const std::string body =
        "{\"type\":\"urn:sheetform:problem:overloaded\",\"title\":\"Too many connections\",\"status\":503,"
        "\"retryable\":true,\"detail\":\"all threads of the server are busy\",\"fix\":\"try again in a "
        "second\"}\n";
    return "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nRetry-After: 1\r\n"
           "Content-Length: " +
           std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" + body;
  }();
  return whole;
}

[[noreturn]] void refuse(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

std::string address_text(const sockaddr_storage& address) {
  char text[INET6_ADDRSTRLEN] = "";
  if (address.ss_family == AF_INET) {
    sockaddr_in v4;
    std::copy_n(reinterpret_cast<const char*>(&address), sizeof v4, reinterpret_cast<char*>(&v4));
    ::inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
  } else if (address.ss_family == AF_INET6) {
    sockaddr_in6 v6;
    std::copy_n(reinterpret_cast<const char*>(&address), sizeof v6, reinterpret_cast<char*>(&v6));
    ::inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
  }
  return text;
}

std::uint64_t network_of(const sockaddr_storage& address) {
  std::uint64_t network = 0;
  const auto* bytes = reinterpret_cast<const char*>(&address);
  if (address.ss_family == AF_INET)
    std::memcpy(&network, bytes + offsetof(sockaddr_in, sin_addr), sizeof(in_addr));
  else if (address.ss_family == AF_INET6)
    std::memcpy(&network, bytes + offsetof(sockaddr_in6, sin6_addr), sizeof network);
  return network;
}

struct AddressList {
  addrinfo* first = nullptr;
  ~AddressList() {
    if (first != nullptr) ::freeaddrinfo(first);
  }
};

Descriptor open_listener(const addrinfo& a) {
  Descriptor fd(::socket(a.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd.valid()) refuse("socket");
  const int on = 1;
  ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on,
               sizeof on);  // never REUSEPORT: two servers would share the calls
  if (a.ai_family == AF_INET6) ::setsockopt(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  if (::bind(fd.get(), a.ai_addr, a.ai_addrlen) != 0) refuse("bind");
  if (::listen(fd.get(), kBacklog) != 0) refuse("listen");
  return fd;
}

int port_of(int fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) refuse("getsockname");
  const auto* v4 =
      reinterpret_cast<const sockaddr_in*>(&address);  // the port lies at the same place in both families
  return ntohs(v4->sin_port);
}

void set_blocking(int fd, bool blocking) {
  const int flags = ::fcntl(fd, F_GETFL);
  ::fcntl(fd, F_SETFL, blocking ? flags & ~O_NONBLOCK : flags | O_NONBLOCK);
}

bool watch(int epoll, int fd) {
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP;
  event.data.fd = fd;
  return ::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

bool is_shortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

}  // namespace

bool ListenAddress::loopback() const {
  return host == "localhost" || host == "::1" || host.rfind("127.", 0) == 0;
}

std::string ListenAddress::text() const {
  return (host.find(':') != std::string::npos ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

bool parse_address(const std::string& text, ListenAddress& address) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  std::string host = text.substr(0, colon);
  const bool bracketed = host.front() == '[' && host.back() == ']' && host.size() > 2;
  if (bracketed)
    host = host.substr(1, host.size() - 2);
  else if (host.find(':') != std::string::npos)
    return false;
  const std::string port = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || end != port.data() + port.size() || address.port < 0 || address.port > 65535)
    return false;
  address.host = host;
  return true;
}

ConnectionGate::ConnectionGate(GateLimits limits, std::function<bool(Arrival&)> arrived)
    : limits_(limits),
      arrived_(std::move(arrived)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!epoll_.valid() || !wake_.valid() || !watch(epoll_.get(), wake_.get())) refuse("epoll");
}

ConnectionGate::~ConnectionGate() = default;

int ConnectionGate::listen(const ListenAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  AddressList found;
  if (::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found.first) != 0 ||
      found.first == nullptr) {
    errno = EADDRNOTAVAIL;
    refuse("the address " + address.text());
  }
  try {
    listeners_.push_back(open_listener(*found.first));
  } catch (const std::system_error& e) {
    throw std::system_error(e.code(), "the address " + address.text());
  }
  if (!watch(epoll_.get(), listeners_.back().get())) refuse("epoll");
  return port_of(listeners_.back().get());
}

void ConnectionGate::stop() {
  stopping_ = true;
  const std::uint64_t one = 1;
  if (::write(wake_.get(), &one, sizeof one) < 0) return;
}

void ConnectionGate::run() {
  std::array<epoll_event, 64> events;
  while (!stopping_) {
    const int count =
        ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), kTickMilliseconds);
    last_turn_ = SteadyClock::now().time_since_epoch().count();
    for (int i = 0; i < count; ++i) {
      const int fd = events[static_cast<std::size_t>(i)].data.fd;
      const bool listener = std::any_of(listeners_.begin(), listeners_.end(),
                                        [fd](const Descriptor& d) { return d.get() == fd; });
      if (listener)
        accept_all(fd);
      else if (fd != wake_.get())
        read_from(fd);
    }
    drop_late();
  }
  listeners_.clear();
  waiting_.clear();
  networks_.clear();
  waiting_count_ = 0;
}

void ConnectionGate::accept_all(int listener) {
  for (int i = 0; i < 256; ++i) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    Descriptor socket(
        ::accept4(listener, reinterpret_cast<sockaddr*>(&address), &size, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.valid())
      take(std::move(socket), address);
    else if (is_shortage(errno))
      return make_room();
    else if (errno == EAGAIN || errno == EWOULDBLOCK)
      return;
    // Everything else concerns the one connection that failed (ECONNABORTED and the like).
  }
}

/// One connection goes for those that are not accepted yet. When none can, they wait, and so does the loop:
/// it would be woken at once, again and again, and has nobody else to see to.
void ConnectionGate::make_room() {
  if (waiting_.empty())
    std::this_thread::sleep_for(kShortagePause);
  else
    drop_oldest();
}

void ConnectionGate::take(Descriptor socket, const sockaddr_storage& peer) {
  if (waiting_.size() >= limits_.waiting) drop_oldest();
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsentBytes, sizeof kUnsentBytes);
  const int fd = socket.get();
  if (!watch(epoll_.get(), fd)) return;
  const auto network = networks_.try_emplace(network_of(peer), 0).first;
  ++network->second;
  waiting_.emplace(
      fd,
      Waiting{std::move(socket), address_text(peer), {}, SteadyClock::now() + limits_.head_time, network});
  waiting_count_ = static_cast<int>(waiting_.size());
}

void ConnectionGate::forget(WaitingMap::iterator waiting) {
  const auto network = waiting->second.network;
  if (--network->second == 0) networks_.erase(network);
  waiting_.erase(waiting);
  waiting_count_ = static_cast<int>(waiting_.size());
}

void ConnectionGate::read_from(int fd) {
  const auto found = waiting_.find(fd);
  if (found == waiting_.end()) return;
  Waiting& w = found->second;
  char buffer[kHeadBytes];
  const ssize_t got = ::recv(fd, buffer, sizeof buffer, 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (got <= 0) return forget(found);
  const std::size_t before = w.bytes.size();
  w.bytes.append(buffer, static_cast<std::size_t>(got));
  // Empty lines before a request are allowed, and skipped.
  while (w.bytes.rfind("\r\n", 0) == 0) w.bytes.erase(0, 2);
  // A client that begins TLS would wait for its answer until its patience ends.
  if (!w.bytes.empty() && w.bytes.front() == kTlsHandshake) return hand_over(fd, Arrival::Kind::kNotHttp, 0);
  const std::size_t end = find_head_end(w.bytes, std::min(before, w.bytes.size()));
  if (end != std::string::npos && end <= kHeadBytes)
    hand_over(fd, Arrival::Kind::kHead, end);
  else if (w.bytes.size() > kHeadBytes || end != std::string::npos)
    hand_over(fd, Arrival::Kind::kTooLarge, 0);
}

void ConnectionGate::hand_over(int fd, Arrival::Kind kind, std::size_t head_end) {
  const auto found = waiting_.find(fd);
  Arrival arrival;
  arrival.kind = kind;
  arrival.socket = std::move(found->second.socket);
  arrival.peer = std::move(found->second.peer);
  arrival.bytes = std::move(found->second.bytes);
  arrival.head_end = head_end;
  forget(found);
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, fd, nullptr);
  set_blocking(fd, true);
  if (!arrived_(arrival)) shed_one(std::move(arrival.socket));
}

void ConnectionGate::shed_one(Descriptor socket) {
  ++shed_;
  const std::string& answer = shed_answer();
  if (::send(socket.get(), answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0) return;
  ::shutdown(socket.get(), SHUT_WR);
}

/// Of the network that has most, so that one client pushes out its own connections and not those of others.
void ConnectionGate::drop_oldest() {
  if (waiting_.empty()) return;
  const auto first = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
    const int held_by_a = a.second.network->second, held_by_b = b.second.network->second;
    return held_by_a != held_by_b ? held_by_a > held_by_b : a.second.deadline < b.second.deadline;
  });
  ++shed_;
  forget(first);
}

void ConnectionGate::drop_late() {
  const auto now = SteadyClock::now();
  std::vector<int> late;
  for (const auto& [fd, w] : waiting_)
    if (w.deadline < now) late.push_back(fd);
  for (const int fd : late) {
    if (waiting_.at(fd).bytes.empty())
      forget(waiting_.find(fd));  // nothing was asked, nothing is answered
    else
      hand_over(fd, Arrival::Kind::kTooSlow, 0);
  }
}

}  // namespace sheetform::server
