// The HTTP server: Debian's stock cpp-httplib writes the responses, everything that comes from strangers is
// read by our own strict code before it. httplib sees a method and nothing else of a request.
#pragma once
#include <memory>
#include <set>
#include <thread>

#include "server/http/body_reader.h"
#include "server/http/connection_gate.h"
#include "server/http/thread_crew.h"

#include "server/http/answer.h"

namespace sheetform::server {

struct GuardOptions {
  GateLimits gate;
  BodyPatience patience;
  int threads = 512;  ///< connections that are answered at once; event streams count
};

/// Options for a process that may have so many descriptors: a quarter of them for connections that wait, a
/// half for those that are answered (socket and file), the rest for the store and the jobs, whatever
/// strangers hold.
GuardOptions options_within(std::uint64_t descriptors);

/// A request whose head has been read, or could not be.
struct GuardedRequest {
  const RequestHead& head;
  BodyReader& body;
  std::string peer;
  std::optional<HeadError> error;  ///< set: the head is not usable, only `error` counts
};

/// What became of a request, for the log and the figures.
struct Served {
  int status = 0;
  std::uint64_t bytes_in = 0, bytes_out = 0;
  double seconds = 0;
};

class GuardServer {
 public:
  using Dispatch = std::function<Answer(GuardedRequest&)>;
  using Report = std::function<void(const GuardedRequest&, const Answer&, const Served&)>;

  /// dispatch must not throw. report is called after every response.
  GuardServer(GuardOptions options, Dispatch dispatch, Report report);
  ~GuardServer();
  GuardServer(const GuardServer&) = delete;
  GuardServer& operator=(const GuardServer&) = delete;

  int listen(const ListenAddress& address) { return gate_.listen(address); }
  /// Starts to accept, in a thread of its own.
  void start();
  /// Accepts nothing more; lets responses finish until `until`, then cuts the rest. True when none had to be
  /// cut.
  bool drain(SteadyClock::time_point until);

  int busy() const { return crew_.busy(); }
  int waiting() const { return gate_.waiting(); }
  std::uint64_t shed() const { return gate_.shed(); }
  SteadyClock::time_point last_turn() const { return gate_.last_turn(); }

 private:
  class Backend;
  class Answering;
  void serve(Arrival& arrival);

  GuardOptions options_;
  Dispatch dispatch_;
  Report report_;
  std::unique_ptr<Backend> backend_;
  std::mutex sockets_mutex_;
  std::set<int> sockets_;  ///< that are being answered, for drain() to cut
  ThreadCrew crew_;
  ConnectionGate gate_;
  std::thread gate_thread_;
};

}  // namespace sheetform::server
