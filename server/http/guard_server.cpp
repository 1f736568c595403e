#include "server/http/guard_server.h"

#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/base/log.h"

namespace sheetform::server {
namespace {

constexpr std::uint64_t kPiece = 256 * 1024;
constexpr std::uint64_t kLingerBytes = std::uint64_t{8} << 20;
constexpr auto kLingerTime = std::chrono::seconds(2);

/// httplib's view of the connection: it reads a request head made by us, and writes to the real socket.
class GuardStream : public httplib::Stream {
 public:
  GuardStream(int fd, const std::string& method, const BodyPatience& patience)
      : fd_(fd), patience_(patience), head_(method + " / HTTP/1.1\r\n\r\n") {}

  bool is_readable() const override { return at_ < head_.size(); }
  bool is_writable() const override { return !broken_; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, head_.size() - at_);
    std::copy_n(head_.data() + at_, count, to);
    at_ += count;
    return static_cast<ssize_t>(count);
  }
  using httplib::Stream::write;
  ssize_t write(const char* data, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  socket_t socket() const override { return fd_; }

  std::uint64_t written() const { return written_; }

 private:
  int fd_;
  const BodyPatience& patience_;
  std::string head_;
  std::size_t at_ = 0;
  bool head_sent_ = false, broken_ = false;
  std::uint64_t written_ = 0;
};

/// A response without body by its status has no Content-Length either (RFC 9110, 8.6); httplib writes one.
std::string without_zero_length(std::string head) {
  constexpr std::string_view kZero = "Content-Length: 0\r\n";
  const bool bodyless = head.rfind("HTTP/1.1 204", 0) == 0 || head.rfind("HTTP/1.1 304", 0) == 0;
  const std::size_t at = bodyless ? head.find(kZero) : std::string::npos;
  return at == std::string::npos ? head : head.erase(at, kZero.size());
}

ssize_t GuardStream::write(const char* data, std::size_t size) {
  if (broken_) return -1;
  bool sent;
  if (head_sent_)
    sent = send_all(fd_, {data, size}, patience_);
  else
    sent = send_all(fd_, without_zero_length(std::string(data, size)), patience_);
  head_sent_ = true;
  broken_ = !sent;
  written_ += sent ? size : 0;
  return sent ? static_cast<ssize_t>(size) : -1;
}

/// Reads what the client still sends, for a while, so that it sees our answer instead of a reset.
void linger(int fd) {
  ::shutdown(fd, SHUT_WR);
  char buffer[16384];
  const auto until = SteadyClock::now() + kLingerTime;
  for (std::uint64_t total = 0; total < kLingerBytes && SteadyClock::now() < until;) {
    pollfd end{fd, POLLIN, 0};
    if (::poll(&end, 1, 200) < 0) return;
    if (end.revents == 0) continue;
    const ssize_t got = ::recv(fd, buffer, sizeof buffer, MSG_DONTWAIT);
    if (got <= 0) return;
    total += static_cast<std::uint64_t>(got);
  }
}

void fill_pieces(httplib::Response& response, const Answer& answer) {
  const std::shared_ptr<PiecewiseContent> content = answer.pieces;
  if (content->length == 0) return response.set_content("", answer.media_type);
  response.set_content_provider(
      content->length, answer.media_type,
      [content](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        try {
          const std::string piece = content->read(offset, std::min<std::uint64_t>(length, kPiece));
          return !piece.empty() && piece.size() <= length && sink.write(piece.data(), piece.size());
        } catch (const std::exception& e) {
          log_error("a download broke off", {{"reason", e.what()}});
          return false;
        }
      });
}

void fill_live(httplib::Response& response, const Answer& answer) {
  const std::shared_ptr<LiveContent> content = answer.live;
  response.set_content_provider(answer.media_type, [content](std::size_t, httplib::DataSink& sink) {
    try {
      const auto write = [&sink](std::string_view text) { return sink.write(text.data(), text.size()); };
      if (content->step(write)) return true;
      sink.done();
      return true;
    } catch (const std::exception& e) {
      log_error("a stream broke off", {{"reason", e.what()}});
      return false;
    }
  });
}

void fill(httplib::Response& response, const Answer& answer) {
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) response.headers.emplace(name, value);
  if (answer.pieces)
    fill_pieces(response, answer);
  else if (answer.live)
    fill_live(response, answer);
  else if (!answer.body.empty())
    response.set_content(answer.body, answer.media_type);
}

}  // namespace

/// The stock server, used for one thing: writing one response to one stream.
class GuardServer::Backend : private httplib::Server {
 public:
  Backend() {
    svr_sock_ = 0;  // httplib takes -1 for "shut down" and would cut every download
    set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
      fill(response, *current_);
      return HandlerResponse::Handled;
    });
  }
  ~Backend() override { svr_sock_ = INVALID_SOCKET; }

  void write(httplib::Stream& stream, const Answer& answer) {
    current_ = &answer;
    bool closed = true;
    process_request(stream, true, closed, nullptr);
    current_ = nullptr;
  }

 private:
  static thread_local const Answer* current_;
};

thread_local const Answer* GuardServer::Backend::current_ = nullptr;

GuardOptions options_within(std::uint64_t descriptors) {
  GuardOptions options;
  const std::uint64_t quarter = descriptors / 4;
  options.gate.waiting = static_cast<std::size_t>(std::min<std::uint64_t>(options.gate.waiting, quarter));
  options.threads =
      static_cast<int>(std::min<std::uint64_t>(static_cast<unsigned>(options.threads), quarter));
  return options;
}

GuardServer::GuardServer(GuardOptions options, Dispatch dispatch, Report report)
    : options_(options),
      dispatch_(std::move(dispatch)),
      report_(std::move(report)),
      backend_(std::make_unique<Backend>()),
      crew_(options.threads),
      gate_(options.gate, [this](Arrival& arrival) {
        const auto owned = std::make_shared<Arrival>(std::move(arrival));
        if (crew_.submit([this, owned] { serve(*owned); })) return true;
        arrival = std::move(*owned);
        return false;
      }) {}

GuardServer::~GuardServer() { drain(SteadyClock::now()); }

void GuardServer::start() {
  gate_thread_ = std::thread([this] { gate_.run(); });
}

bool GuardServer::drain(SteadyClock::time_point until) {
  gate_.stop();
  if (gate_thread_.joinable()) gate_thread_.join();
  const bool clean = crew_.wait_idle(until);
  if (clean) return true;
  {
    const std::lock_guard lock(sockets_mutex_);
    for (const int fd : sockets_) ::shutdown(fd, SHUT_RDWR);
  }
  crew_.wait_idle(SteadyClock::now() + std::chrono::seconds(10));
  return false;
}

namespace {

std::optional<HeadError> read_head(const Arrival& arrival, RequestHead& head) {
  HeadError error;
  switch (arrival.kind) {
    case Arrival::Kind::kTooLarge:
      return HeadError{api::ProblemType::kHeadersTooLarge,
                       "the head is larger than " + std::to_string(kHeadBytes) + " bytes"};
    case Arrival::Kind::kTooSlow:
      return HeadError{api::ProblemType::kRequestTimeout, "the head did not come"};
    case Arrival::Kind::kNotHttp:
      return HeadError{api::ProblemType::kMalformedRequest,
                       "this is no HTTP; the server itself speaks no TLS, so ask for http://"};
    case Arrival::Kind::kHead:
      break;
  }
  if (parse_request_head(std::string_view(arrival.bytes).substr(0, arrival.head_end), head, error))
    return std::nullopt;
  head = RequestHead();
  return error;
}

}  // namespace

/// The number is another's as soon as the socket is closed, so it goes before that, however the answer ends.
class GuardServer::Answering {
 public:
  Answering(GuardServer& server, int fd) : server_(server), fd_(fd) {
    const std::lock_guard lock(server_.sockets_mutex_);
    server_.sockets_.insert(fd_);
  }
  ~Answering() {
    const std::lock_guard lock(server_.sockets_mutex_);
    server_.sockets_.erase(fd_);
  }
  Answering(const Answering&) = delete;
  Answering& operator=(const Answering&) = delete;

 private:
  GuardServer& server_;
  int fd_;
};

void GuardServer::serve(Arrival& arrival) {
  const auto begun = SteadyClock::now();
  const int fd = arrival.socket.get();
  const Answering answering(*this, fd);
  RequestHead head;
  const std::optional<HeadError> error = read_head(arrival, head);
  BodyReader body(fd, arrival.bytes.substr(arrival.head_end), head, options_.patience);
  GuardedRequest request{head, body, arrival.peer, error};
  const Answer answer = dispatch_(request);
  GuardStream stream(fd, head.method == "HEAD" ? "HEAD" : "GET", options_.patience);
  backend_->write(stream, answer);
  report_(request, answer,
          {answer.status, body.bytes(), stream.written(),
           std::chrono::duration<double>(SteadyClock::now() - begun).count()});
  if (!body.finished()) linger(fd);
}

}  // namespace sheetform::server
