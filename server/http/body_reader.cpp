#include "server/http/body_reader.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace sheetform::server {
namespace {

constexpr std::size_t kPiece = 64 * 1024;
constexpr int kSizeDigits = 8;
constexpr std::size_t kExtensionBytes = 256, kTrailerBytes = 4096;

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Whether `fd` became ready within the time.
bool wait_for(int fd, short what, std::chrono::milliseconds time) {
  pollfd end{fd, what, 0};
  int ready = 0;
  do ready = ::poll(&end, 1, static_cast<int>(time.count()));
  while (ready < 0 && errno == EINTR);
  return ready > 0;
}

bool is_too_slow(std::uint64_t bytes, SteadyClock::duration time, const BodyPatience& patience) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time).count();
  return time >= patience.grace && bytes < patience.bytes_per_second * static_cast<std::uint64_t>(seconds);
}

}  // namespace

bool ChunkDecoder::take_size(char c) {
  const int value = hex_value(c);
  if (value >= 0) {
    left_ = left_ * 16 + static_cast<unsigned>(value);
    return ++digits_ <= kSizeDigits;
  }
  if (digits_ == 0) return false;
  if (c == ';')
    state_ = State::kExtension;
  else if (c == '\r')
    state_ = State::kSizeEnd;
  else
    return false;
  return true;
}

bool ChunkDecoder::after_size() {
  digits_ = 0;
  line_ = 0;
  state_ = left_ == 0 ? State::kTrailer : State::kData;
  return true;
}

/// Trailers end with an empty line; line_ counts the characters of the present one, CR included.
bool ChunkDecoder::take_trailer(char c) {
  if (++trailer_bytes_ > kTrailerBytes) return false;
  if (c != '\n') {
    ++line_;
    after_cr_ = c == '\r';  // the last character was CR
    return true;
  }
  if (!after_cr_) return false;
  if (line_ == 1) state_ = State::kDone;
  line_ = 0;
  after_cr_ = false;
  return true;
}

bool ChunkDecoder::decode(std::string_view& input, std::string& body) {
  while (!input.empty() && state_ != State::kDone) {
    if (state_ == State::kData) {
      const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, input.size()));
      body.append(input.substr(0, count));
      input.remove_prefix(count);
      left_ -= count;
      if (left_ == 0) state_ = State::kDataCr;
      continue;
    }
    const char c = input.front();
    input.remove_prefix(1);
    bool good = true;
    switch (state_) {
      case State::kSize:
        good = take_size(c);
        break;
      case State::kExtension:
        if (c == '\r')
          state_ = State::kSizeEnd;
        else
          good = c != '\n' && ++line_ <= kExtensionBytes;
        break;
      case State::kSizeEnd:
        good = c == '\n' && after_size();
        break;
      case State::kDataCr:
        good = c == '\r';
        state_ = State::kDataLf;
        break;
      case State::kDataLf:
        good = c == '\n';
        state_ = State::kSize;
        break;
      case State::kTrailer:
        good = take_trailer(c);
        break;
      case State::kData:
      case State::kDone:
        break;
    }
    if (!good) return false;
  }
  return true;
}

BodyReader::BodyReader(int fd, std::string buffered, const RequestHead& head, const BodyPatience& patience)
    : fd_(fd),
      buffered_(std::move(buffered)),
      chunked_(head.chunked),
      continue_pending_(head.expects_continue),
      finished_(!head.has_body()),
      left_(head.content_length.value_or(0)),
      patience_(patience) {}

void BodyReader::set_limit(std::uint64_t bytes) {
  limit_ = bytes;
  if (!chunked_ && left_ > limit_)
    throw BodyError(api::ProblemType::kPayloadTooLarge,
                    "the body has " + std::to_string(left_) + " bytes, more than " + std::to_string(limit_));
}

void BodyReader::check_speed() const {
  if (is_too_slow(bytes_, SteadyClock::now() - begun_, patience_))
    throw BodyError(api::ProblemType::kRequestTimeout, "the body came too slowly");
}

std::string_view BodyReader::receive() {
  if (!buffered_.empty()) {
    room_ = std::exchange(buffered_, {});
    return room_;
  }
  if (continue_pending_) {
    continue_pending_ = false;
    send_all(fd_, "HTTP/1.1 100 Continue\r\n\r\n", patience_);
  }
  check_speed();
  if (!wait_for(fd_, POLLIN, patience_.stall))
    throw BodyError(api::ProblemType::kRequestTimeout, "the body did not come");
  room_.resize(kPiece);
  const ssize_t got = ::recv(fd_, room_.data(), room_.size(), 0);
  if (got < 0 && (errno == EINTR || errno == EAGAIN)) return {};
  if (got <= 0)
    throw BodyError(api::ProblemType::kMalformedRequest, "the connection ended before the body did");
  return std::string_view(room_).substr(0, static_cast<std::size_t>(got));
}

std::string_view BodyReader::take_plain(std::string_view raw) {
  // A second request is not answered.
  raw = raw.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(raw.size(), left_)));
  left_ -= raw.size();
  finished_ = left_ == 0;
  return raw;
}

std::string_view BodyReader::take_chunked(std::string_view raw) {
  decoded_.clear();
  if (!chunks_.decode(raw, decoded_))
    throw BodyError(api::ProblemType::kMalformedRequest, "the chunked coding of the body is broken");
  finished_ = chunks_.done();
  return decoded_;
}

std::string_view BodyReader::read() {
  std::string_view piece;
  while (piece.empty() && !finished_) {
    const std::string_view raw = receive();
    if (raw.empty()) continue;
    piece = chunked_ ? take_chunked(raw) : take_plain(raw);
    bytes_ += piece.size();
    if (bytes_ > limit_)
      throw BodyError(api::ProblemType::kPayloadTooLarge,
                      "the body has more than " + std::to_string(limit_) + " bytes");
  }
  if (hash_ != nullptr) hash_->add(piece);
  return piece;
}

std::string BodyReader::read_all() {
  std::string body;
  for (std::string_view piece; !(piece = read()).empty();) body += piece;
  return body;
}

bool send_all(int fd, std::string_view bytes, const BodyPatience& patience) {
  const auto begun = SteadyClock::now();
  std::uint64_t sent = 0;
  while (!bytes.empty()) {
    const ssize_t put = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (put > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(put));
      sent += static_cast<std::uint64_t>(put);
      continue;
    }
    if (put < 0 && errno == EINTR) continue;
    if (put < 0 && errno != EAGAIN && errno != EWOULDBLOCK) return false;
    if (!wait_for(fd, POLLOUT, patience.send_stall)) return false;
    if (is_too_slow(sent, SteadyClock::now() - begun, patience)) return false;
  }
  return true;
}

}  // namespace sheetform::server
