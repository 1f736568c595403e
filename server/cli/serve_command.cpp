// `sheetform serve`: opens the store, starts slots and HTTP, waits for a signal, stops in order.
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <system_error>
#include <thread>

#include "server/base/file_output.h"
#include "server/base/identity.h"
#include "server/base/log.h"
#include "server/cli/commands.h"
#include "server/http/api_server.h"
#include "server/jobs/worker_probe.h"
#include "server/mapping/errors.h"
#include "server/mapping/exports.h"

namespace sheetform::server {
namespace {

constexpr auto kHousekeeping = std::chrono::minutes(10);
constexpr auto kWatch = std::chrono::seconds(1);
constexpr auto kStalled = std::chrono::seconds(30);

[[noreturn]] void wrong(const std::string& what, const std::string& where, const std::string& fix) {
  throw Error(ErrorCode::kInvalidParameter, what, where, fix);
}

std::vector<ListenAddress> addresses_of(const ParsedLine& line) {
  std::vector<ListenAddress> list;
  const std::string text = line.get("--listen", "127.0.0.1:8080");
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    ListenAddress address;
    if (!parse_address(text.substr(at, end - at), address))
      wrong("\"" + text.substr(at, end - at) + "\" is no address", "--listen",
            "write HOST:PORT, e.g. 127.0.0.1:8080");
    list.push_back(address);
    at = end + 1;
  }
  return list;
}

std::uint64_t mebibytes(const ParsedLine& line, const char* option, std::uint64_t fallback) {
  if (!line.has(option)) return fallback;
  return static_cast<std::uint64_t>(whole_number(option, line.get(option), 0, std::int64_t{1} << 30)) << 20;
}

int small_number(const ParsedLine& line, const char* option, int fallback, int low, int high) {
  return line.has(option) ? static_cast<int>(whole_number(option, line.get(option), low, high)) : fallback;
}

ServiceLimits limits_of(const ParsedLine& line) {
  ServiceLimits l;
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  l.slots = small_number(line, "--slots", std::max(1, cores - 1), 1, 1024);
  l.threads = small_number(line, "--threads", std::max(1, cores / l.slots), 1, 1024);
  l.job_seconds = small_number(line, "--job-seconds", l.job_seconds, 1, 86400);
  l.job_memory = mebibytes(line, "--job-memory", l.job_memory);
  l.upload_bytes = mebibytes(line, "--max-upload", l.upload_bytes);
  l.free_bytes = mebibytes(line, "--min-free", l.free_bytes);
  l.stored_bytes = mebibytes(line, "--quota", l.stored_bytes);
  l.queued_jobs = small_number(line, "--queue", static_cast<int>(l.queued_jobs), 1, 10'000'000);
  l.queued_jobs_each = small_number(line, "--queue-each", static_cast<int>(l.queued_jobs), 1, 10'000'000);
  l.keep_results = small_number(line, "--keep-days", 30, 1, 36500) * kDay;
  l.submits_per_minute = small_number(line, "--submits-per-minute", 0, 0, 1'000'000);
  return l;
}

bool all_loopback(const std::vector<ListenAddress>& addresses) {
  for (const ListenAddress& a : addresses)
    if (!a.loopback()) return false;
  return true;
}

/// Names that Host may have; empty when the server stands behind names that nobody told it.
std::set<std::string> hosts_of(const std::vector<ListenAddress>& addresses, const std::string& public_url) {
  std::set<std::string> hosts{"localhost", "127.0.0.1", "::1"};
  for (const ListenAddress& a : addresses) hosts.insert(a.host);
  const std::size_t scheme = public_url.find("://");
  if (scheme != std::string::npos)
    hosts.insert(host_name(public_url.substr(scheme + 3, public_url.find('/', scheme + 3) - scheme - 3)));
  return hosts;
}

/// The one token that came by a file or the environment's word for one (a secret of the container), and, on
/// wish, one that is made now.
std::string secret_of(const ParsedLine& line, const std::filesystem::path& data) {
  const char* named = std::getenv("SHEETFORM_TOKEN_FILE");
  std::string path = line.get("--token-file", named != nullptr ? named : "");
  if (path.empty() && line.has("--make-token")) {
    const std::filesystem::path made = data / "token";
    if (!std::filesystem::exists(made)) {
      std::filesystem::create_directories(data);
      write_synced(made, "sf_made_" + to_hex(random_bytes(32)) + "\n");
      std::filesystem::permissions(made,
                                   std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    }
    log_info("the token is in a file", {{"file", made.string()}});
    path = made.string();
  }
  if (path.empty()) return {};
  std::string secret = read_input_file(path, 4096);
  while (!secret.empty() && std::isspace(static_cast<unsigned char>(secret.back())) != 0) secret.pop_back();
  if (secret.size() < 16)
    wrong("the token in " + path + " is shorter than 16 characters", "--token-file", "use a long random one");
  return secret;
}

AuthOptions auth_of(const ParsedLine& line, const std::vector<ListenAddress>& addresses,
                    const std::string& public_url, bool any_token) {
  AuthOptions auth;
  const bool local = all_loopback(addresses), open = line.has("--insecure-no-auth");
  if (!local && !any_token && !open)
    wrong("an address that others can reach needs a token", "--listen",
          "make one with `sheetform token add NAME --data DIR`, or allow everyone with --insecure-no-auth");
  auth.needed = !open && (any_token || line.has("--require-token"));
  // A token protects whatever the name is. Where none is asked for, a page of others could have its own name
  // point here (DNS rebinding), so names must be told; addresses need not.
  const bool named = !public_url.empty();
  if (local || named || !auth.needed) auth.hosts = hosts_of(addresses, public_url);
  auth.any_address = !local && !named;
  if (!auth.needed && named)
    log_warning("everyone who can reach the server may do everything", {{"url", public_url}});
  return auth;
}

std::string public_url_of(const ParsedLine& line) {
  const char* told = std::getenv("SHEETFORM_PUBLIC_URL");
  std::string url = line.get("--public-url", told != nullptr ? told : "");
  while (!url.empty() && url.back() == '/') url.pop_back();
  if (!url.empty() && url.rfind("http://", 0) != 0 && url.rfind("https://", 0) != 0)
    wrong("\"" + url + "\" is no URL", "--public-url", "give it whole, as in https://sheets.example.org");
  return url;
}

std::string profiles_of(const ParsedLine& line) {
  const std::string path = line.get("--profiles");
  if (path.empty()) return {};
  const std::string json = read_input_file(path, 1 << 20);
  check_profiles(json);
  return json;
}

/// As many descriptors as the system allows this process; the usual limit is for programs that use select().
std::uint64_t raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
  ::getrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}

ApiOptions api_options(const ParsedLine& line, const std::vector<ListenAddress>& addresses,
                       const std::filesystem::path& data) {
  ApiOptions o;
  o.guard = options_within(raise_descriptor_limit());
  o.token_file = data / "tokens.json";
  o.secret = secret_of(line, data);
  o.public_url = public_url_of(line);
  o.auth =
      auth_of(line, addresses, o.public_url, !o.secret.empty() || !TokenFile(o.token_file).list().empty());
  o.web_folder = line.get("--web-dir");
  o.log_requests = !line.has("--quiet");
  return o;
}

/// Keeps house, and ends the process when the accept loop has stood still: a restart helps, waiting does not.
class Caretaker {
 public:
  Caretaker(JobService& service, const ApiServer& server)
      : service_(service), server_(server), thread_([this] { run(); }) {}
  ~Caretaker() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }
  Caretaker(const Caretaker&) = delete;
  Caretaker& operator=(const Caretaker&) = delete;

 private:
  void run() {
    auto well = SteadyClock::now(), cleaned = well - 2 * kHousekeeping;  // at once, also just after a boot
    std::unique_lock lock(mutex_);
    while (!ending_) {
      lock.unlock();
      const auto now = SteadyClock::now();
      if (server_.alive()) well = now;
      if (now - well > kStalled) {
        log_error("the server stands still, the process ends");
        ::_exit(kExitOurs);
      }
      if (now - cleaned > kHousekeeping) {
        keep(&JobService::keep_house);
        cleaned = SteadyClock::now();
      }
      keep(&JobService::keep_quota);
      lock.lock();
      wake_.wait_for(lock, kWatch, [this] { return ending_; });
    }
  }
  void keep(void (JobService::*what)()) {
    try {
      (service_.*what)();
    } catch (const std::exception& e) {
      log_error("housekeeping failed", {{"reason", e.what()}});
    }
  }

  JobService& service_;
  const ApiServer& server_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread thread_;
};

sigset_t stop_signals() {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, SIGTERM);
  ::sigaddset(&set, SIGINT);
  return set;
}

int wait_for_stop(const sigset_t& set) {
  int signal = 0;
  while (::sigwait(&set, &signal) != 0) continue;
  return signal;
}

/// A second signal during the drain ends the process at once; kill -9 is survived as well.
void end_on_second_signal(const sigset_t& set) {
  std::thread([set] {
    wait_for_stop(set);
    ::_exit(kExitOurs);
  }).detach();
}

void stop_in_order(JobService& service, ApiServer& server, std::chrono::seconds grace) {
  log_info("stopping", {{"runningJobs", service.running()}, {"graceSeconds", grace.count()}});
  const auto until = SteadyClock::now() + grace;
  service.drain(grace);
  service.end_waits();
  const bool clean = server.drain(until + std::chrono::seconds(1));
  service.store().checkpoint();
  log_info("stopped", {{"connectionsCut", !clean}});
}

void open_the_log(const ParsedLine& line) {
  const std::string style = line.get("--log", ::isatty(STDERR_FILENO) == 1 ? "text" : "json");
  if (style != "text" && style != "json")
    wrong("\"" + style + "\" is no style of log", "--log", "give text or json");
  open_log(style == "json" ? LogStyle::kJson : LogStyle::kText, LogLevel::kInfo);
}

api::Json probed_sandbox(const ParsedLine& line) {
  const api::Json state = probe_worker(!line.has("--no-sandbox"));
  const bool whole = state.value("whole", false);
  if (!whole && line.has("--require-sandbox"))
    throw Error(ErrorCode::kInvalidParameter, "jobs cannot be closed in on this machine", "--require-sandbox",
                "use a kernel with Landlock and seccomp");
  if (!whole) log_warning("jobs are not closed in completely", state);
  return state;
}

}  // namespace

CommandSpec serve_spec() {
  CommandSpec spec;
  spec.name = "serve";
  spec.usage = "[--listen 127.0.0.1:8080] [--data DIR] [options]";
  spec.text =
      "Serves the page and the API, runs uploaded meshes as jobs, keeps everything in the folder DIR.";
  spec.options = {
      {"--listen", "HOST:PORT",
       "Address to listen on, several separated by commas. Default 127.0.0.1:8080. Addresses "
       "that others can reach need a token (see `sheetform token --help`).",
       ""},
      {"--data", "DIR", "Folder of the store; made when it is not there. Default ./sheetform-data.", ""},
      {"--public-url", "URL",
       "How the server is reached from outside, e.g. https://sheets.example.org (also SHEETFORM_PUBLIC_URL).",
       ""},
      {"--web-dir", "DIR", "Serve the page from this folder instead of the one that is built in.", ""},
      {"--profiles", "FILE", "Profiles of your machines for exports (colours, layers, widths), as JSON.", ""},
      {"--slots", "N", "Jobs that run at once. Default: one less than there are cores.", ""},
      {"--threads", "N", "Threads of one job. Default: the cores divided among the slots.", ""},
      {"--job-seconds", "N", "A job that takes longer fails. Default 900.", ""},
      {"--job-memory", "MIB", "A job that needs more memory fails. Default 4096.", ""},
      {"--max-upload", "MIB", "Largest mesh. Default 256.", ""},
      {"--queue", "N", "Most jobs that wait. Default 20000.", ""},
      {"--queue-each", "N", "Most jobs that wait for one token. Default: as --queue.", ""},
      {"--submits-per-minute", "N", "Most jobs in a minute from one token or address. Default 0: no limit.",
       ""},
      {"--keep-days", "N", "Finished jobs are removed after so many days. Default 30.", ""},
      {"--quota", "MIB", "Oldest finished jobs are removed when all together need more. Default 0: no limit.",
       ""},
      {"--min-free", "MIB", "No uploads when the disk has less free space. Default 2048.", ""},
      {"--drain", "SECONDS", "How long running jobs may still take after SIGTERM. Default 25.", ""},
      {"--token-file", "FILE", "One more token, in a file (also SHEETFORM_TOKEN_FILE); it may do everything.",
       ""},
      {"--make-token", "", "Make such a token in DIR/token when there is none.", ""},
      {"--require-token", "", "Ask for a token on loopback addresses too.", ""},
      {"--insecure-no-auth", "", "Let everyone who can reach the address do everything.", ""},
      {"--require-sandbox", "", "Do not start where jobs cannot be closed in.", ""},
      {"--no-sandbox", "", "Do not close jobs in (for finding faults).", ""},
      {"--worker", "PROGRAM", "Program of the jobs' processes instead of this one (for tests).", ""},
      {"--log", "text|json", "Style of the log on stderr. Default: text on a terminal, json elsewhere.", ""},
      {"--quiet", "", "Do not log requests.", "-q"}};
  spec.notes =
      "SIGTERM and Ctrl-C stop the server: running jobs get some time, unfinished ones wait for the next "
      "start.";
  return spec;
}

int serve_command(const ParsedLine& line) {
  open_the_log(line);
  keep_files_private();
  const std::vector<ListenAddress> addresses = addresses_of(line);
  const sigset_t signals = stop_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ServiceOptions options;
  options.data = line.get("--data", "sheetform-data");
  options.limits = limits_of(line);
  options.sandbox = !line.has("--no-sandbox");
  options.worker = line.get("--worker", options.worker);
  options.profiles = profiles_of(line);
  const std::chrono::seconds grace(small_number(line, "--drain", 25, 0, 86400));
  const api::Json sandbox = probed_sandbox(line);
  ApiOptions api = api_options(line, addresses, options.data);
  JobService service(options);

  api.sandbox = sandbox;
  ApiServer server(service, api);
  for (const ListenAddress& address : addresses) {
    ListenAddress bound = address;
    bound.port = server.listen(address);
    log_info(
        "serving",
        {{"url", "http://" + bound.text()}, {"data", options.data.string()}, {"page", server.has_page()}});
  }
  service.start();
  server.start();
  {
    const Caretaker caretaker(service, server);
    wait_for_stop(signals);
    end_on_second_signal(signals);
    stop_in_order(service, server, grace);
  }
  return kExitOk;
}

}  // namespace sheetform::server
