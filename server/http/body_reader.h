// The body of a request, taken from the socket with limits on size, speed and patience.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "server/base/clock.h"
#include "server/base/digest.h"
#include "server/http/request_head.h"

namespace sheetform::server {

/// The body cannot be had; becomes a problem response.
class BodyError : public std::runtime_error {
 public:
  BodyError(api::ProblemType type, const std::string& what) : std::runtime_error(what), type_(type) {}
  api::ProblemType type() const { return type_; }

 private:
  api::ProblemType type_;
};

/// Finds the ends of chunks (RFC 9112, 7.1). Extensions are skipped, trailers are read and thrown away.
class ChunkDecoder {
 public:
  /// Takes some of `input` off its front and appends body bytes to `body`. Returns false when the coding is
  /// broken.
  bool decode(std::string_view& input, std::string& body);
  bool done() const { return state_ == State::kDone; }

 private:
  enum class State { kSize, kExtension, kSizeEnd, kData, kDataCr, kDataLf, kTrailer, kDone };
  bool take_size(char c);
  bool take_trailer(char c);
  bool after_size();

  State state_ = State::kSize;
  std::uint64_t left_ = 0;  ///< of the size being read, then of the chunk
  int digits_ = 0;
  std::size_t line_ = 0, trailer_bytes_ = 0;
  bool after_cr_ = false;
};

struct BodyPatience {
  std::chrono::seconds stall{15};  ///< without a single byte that comes
  /// Without a single byte that goes. Longer: the system of a client that reads slowly has taken a large
  /// piece already, and asks for the next one when much of it has been read.
  std::chrono::seconds send_stall{60};
  std::chrono::seconds grace{10};         ///< before the least speed is asked for
  std::uint64_t bytes_per_second = 1024;  ///< on average, after the grace
};

class BodyReader {
 public:
  /// buffered: bytes that came together with the head.
  BodyReader(int fd, std::string buffered, const RequestHead& head, const BodyPatience& patience);

  /// Most bytes that are taken; a body that announces or holds more is BodyError kPayloadTooLarge. Set before
  /// reading.
  void set_limit(std::uint64_t bytes);
  /// Every byte of the body is added to it, too; before reading.
  void hash_into(Sha256& hash) { hash_ = &hash; }
  /// Next piece, empty at the end; valid until the next call. Throws BodyError.
  std::string_view read();
  /// The whole body.
  std::string read_all();
  bool finished() const { return finished_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::string_view receive();
  void check_speed() const;
  std::string_view take_plain(std::string_view raw);
  std::string_view take_chunked(std::string_view raw);

  int fd_;
  std::string buffered_, room_, decoded_;  // what came with the head; where the socket is read to; of chunks
  bool chunked_, continue_pending_, finished_ = false;
  std::uint64_t left_ = 0, limit_ = 0, bytes_ = 0;
  Sha256* hash_ = nullptr;
  BodyPatience patience_;
  ChunkDecoder chunks_;
  SteadyClock::time_point begun_ = SteadyClock::now();
};

/// Writes all of it; false when the peer is gone or too slow.
bool send_all(int fd, std::string_view bytes, const BodyPatience& patience);

}  // namespace sheetform::server
