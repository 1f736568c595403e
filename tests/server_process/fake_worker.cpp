// A job's process that misbehaves on command: the name of the uploaded mesh says how. It speaks the real
// protocol, so that the server's supervision is tested against every way in which a process can go wrong.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/sandbox.h"
#include "server/jobs/worker_protocol.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// The ways to die are meant; a sanitizer is to report none of them, and its memory cannot be limited.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "handle_segv=0:handle_abort=0"; }
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() { return "handle_segv=0:handle_abort=0"; }
constexpr bool kMemoryHasLimits = false;
#else
constexpr bool kMemoryHasLimits = true;
#endif

namespace sheetform::server {
namespace {

void send_text(const std::string& text) {
  if (::write(kStatusDescriptor, text.data(), text.size()) < 0) ::_exit(99);
}
void send(const WorkerMessage& m) { send_text(to_line(m)); }

std::string read_request() {
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = ::read(kRequestDescriptor, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

void put(const std::string& name, const std::string& content) {
  const int fd = ::openat(kFolderDescriptor, name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (fd < 0 || ::write(fd, content.data(), content.size()) < 0) ::_exit(74);
  ::close(fd);
}

void tell_result(const std::vector<WorkerFile>& files) {
  WorkerMessage m;
  m.result = WorkerMessage::Result{files, {{"patches", 3}, {"e_max_met", true}}, api::Json::array()};
  send(m);
}

void progress(double fraction, const std::string& stage) {
  WorkerMessage m;
  m.progress = WorkerMessage::Progress{fraction, stage, "step"};
  send(m);
}

/// Works for so many milliseconds, with twenty steps of progress, then hands over a good result.
void work(int milliseconds) {
  const char* stages[] = {"prepare", "field", "trace", "insert", "remove"};
  for (int i = 0; i < 20; ++i) {
    progress(i / 20.0, stages[i / 4]);
    std::this_thread::sleep_for(std::chrono::microseconds(milliseconds * 50));
  }
  put("layout.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>\n");
  put("big.bin", std::string(700'000, 'x') + "end");
  put("empty.txt", "");
  tell_result({{"layout.svg", "image/svg+xml"},
               {"big.bin", "application/octet-stream"},
               {"empty.txt", "text/plain"}});
}

void use_up_memory() {
  if (!kMemoryHasLimits) ::_exit(71);
  std::vector<std::string> hoard;
  try {
    for (;;) hoard.emplace_back(std::size_t{64} << 20, 'x');
  } catch (const std::bad_alloc&) {
    ::_exit(71);
  }
}

void refuse_mesh() {
  WorkerMessage m;
  m.problem = api::Problem{};
  m.problem->type = api::ProblemType::kUnsupportedMesh;
  m.problem->detail = "the mesh is a Moebius strip";
  m.problem->where = "face 7";
  m.problem->fix = "cut it open";
  send(m);
  ::_exit(65);
}

void spin() {
  volatile bool on = true;
  while (on) continue;
}

void sleep_deaf() {
  std::signal(SIGTERM, SIG_IGN);
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void flood() {
  for (int i = 0; i < 1'000'000; ++i) progress(0.5, "trace");
}

void link_outside() {
  if (::symlinkat("/etc/passwd", kFolderDescriptor, "layout.svg") != 0) ::_exit(74);
  tell_result({{"layout.svg", "image/svg+xml"}});
}

void talk_nonsense() {
  send_text(
      "this is no "
      "JSON\n{\"progress\":{\"fraction\":7}}\n{\"result\":{\"files\":[{\"name\":\"../x\",\"media\":\"a/"
      "b\"}]}}\n");
  send_text(std::string("\xff\xfe\0\n", 4));
  work(50);
}

/// More than a result may have, in two files of which each alone would do.
void write_too_much() {
  const std::string block(std::size_t{1} << 20, 'x');
  for (const char* name : {"one.bin", "two.bin"}) {
    const int fd = ::openat(kFolderDescriptor, name, O_WRONLY | O_CREAT, 0600);
    for (int i = 0; i < 200; ++i)
      if (::write(fd, block.data(), block.size()) < 0) ::_exit(74);
    ::close(fd);
  }
  tell_result({{"one.bin", "application/octet-stream"}, {"two.bin", "application/octet-stream"}});
}

/// Prints what would colour a terminal, or move its cursor.
void print() {
  const std::string_view text = "first\x1b[31m\r\n\tsecond\n";
  if (::write(2, text.data(), text.size()) < 0) ::_exit(99);
  work(0);
}

/// Closes everything on which the server listens, and lives on for a while.
void fall_silent() {
  progress(0.5, "trace");
  for (const int fd : {1, 2, kStatusDescriptor}) ::close(fd);
  std::this_thread::sleep_for(std::chrono::seconds(3));
}

/// Leaves a process behind and ends as if all were well (the sandbox of the real one forbids it).
void leave_a_child() {
  if (::fork() == 0) sleep_deaf();
}

const std::map<std::string, std::function<void()>> kWays{
    {"segv", [] { progress(0.3, "trace"), ::raise(SIGSEGV); }},
    {"abort", [] { std::abort(); }},
    {"kill", [] { ::raise(SIGKILL); }},
    {"memory", use_up_memory},
    {"refuse", refuse_mesh},
    {"spin", spin},
    {"deaf", sleep_deaf},
    {"flood", flood},
    {"fork", leave_a_child},
    {"huge", write_too_much},
    {"nothing", [] {}},
    {"silent", fall_silent},
    {"print", print},
    {"missing",
     [] {
       tell_result({{"layout.svg", "image/svg+xml"}});
     }},
    {"link", link_outside},
    {"twice",
     [] {
       put("a.svg", "x"), tell_result({{"a.svg", "image/svg+xml"}, {"a.svg", "image/svg+xml"}});
     }},
    {"none", [] { tell_result({}); }},
    {"nonsense", talk_nonsense},
    {"long-line",
     [] {
       send_text(std::string(300'000, 'x'));
       std::this_thread::sleep_for(std::chrono::seconds(5));
     }},
    {"exit", [] { ::_exit(70); }},
    {"io", [] { ::_exit(74); }},
};

/// "segv.obj" -> "segv"; "work-300.obj" works 300 ms.
void behave(const std::string& name) {
  const std::string way = name.substr(0, name.find('.'));
  if (way.rfind("work-", 0) == 0) return work(std::atoi(way.c_str() + 5));
  const auto found = kWays.find(way);
  if (found == kWays.end()) return work(20);
  found->second();
}

void inspect(const WorkerRequest& request) {
  if (request.name.rfind("inspect-segv", 0) == 0) ::raise(SIGSEGV);
  if (request.name.rfind("inspect-spin", 0) == 0) spin();
  struct stat status {};
  ::fstat(kInputDescriptor, &status);
  WorkerMessage m;
  m.mesh = {{"format", "obj"},
            {"vertices", 3},
            {"faces", 1},
            {"name", request.name},
            {"bytes", status.st_size},
            {"bbox", {{"min", {0, 0, 0}}, {"max", {1, 1, 0}}}},
            {"bboxDiagonal", 1.5},
            {"scale", 1},
            {"sizeMm", {1, 1, 0}},
            {"unitAssumed", "1 unit = 1 mm"}};
  send(m);
}

}  // namespace
}  // namespace sheetform::server

int main() {
  using namespace sheetform::server;
  const WorkerRequest request = worker_request_from(read_request());
  lower_process(limits_of(request));
  if (request.mode == WorkerMode::kInspect)
    inspect(request);
  else
    behave(request.name);
  return 0;
}
