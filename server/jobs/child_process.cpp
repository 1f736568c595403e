#include "server/jobs/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>

extern "C" {  // which glibc 2.36 forgets
#include <sys/pidfd.h>
}

#include "server/base/log.h"

namespace sheetform::server {
namespace {

constexpr std::size_t kLogBytes = 256 * 1024;
constexpr int kLinesPerSecond = 200;                        // more is no progress, it is a flood
constexpr auto kPatience = std::chrono::milliseconds(500);  // between SIGTERM and SIGKILL
constexpr auto kTick = std::chrono::milliseconds(250);

[[noreturn]] void refuse(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

struct Pipe {
  Descriptor read_end, write_end;
};

Pipe make_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) refuse("pipe");
  Descriptor first(ends[0]), second(ends[1]);
  Pipe pipe{std::move(first), high_copy(second.get())};
  ::fcntl(pipe.read_end.get(), F_SETFL, O_NONBLOCK);
  return pipe;
}

Descriptor make_request_file(const WorkerRequest& request) {
  WorkerRequest whole = request;
  whole.parent = ::getpid();
  const std::string text = to_text(whole);
  const Descriptor memory(::memfd_create("request", MFD_CLOEXEC));
  if (!memory.valid() || ::write(memory.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    refuse("request of the child");
  ::lseek(memory.get(), 0, SEEK_SET);
  return high_copy(memory.get());
}

pid_t begin_child(const ChildTask& task, const ChildDescriptors& descriptors) {
  if (task.nursery != nullptr)
    if (const pid_t pid = task.nursery->begin(descriptors); pid > 0) return pid;
  SpawnPlan plan;
  plan.give_all(descriptors);
  return plan.start(task.program, "worker");
}

/// The running child and what has been heard from it.
class Watch {
 public:
  Watch(const ChildTask& task, ChildReport& report) : task_(task), report_(report) { start(); }
  /// Whoever stops listening (on_message threw) leaves no child behind.
  ~Watch() {
    if (!gone_ && pid_ > 0) put_down();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  void run() {
    while (!gone_) {
      std::array<pollfd, 4> ends{
          pollfd{status_.get(), POLLIN, 0}, pollfd{log_.get(), POLLIN, 0}, pollfd{pid_file_.get(), POLLIN, 0},
          pollfd{stopping_ || task_.stop == nullptr ? -1 : task_.stop->descriptor(), POLLIN, 0}};
      ::poll(ends.data(), ends.size(), static_cast<int>(kTick.count()));
      read_log();
      read_status();
      // A pipe that the child has closed is ready for ever; waiting for it would keep a processor busy.
      if (ends[0].revents == POLLHUP) status_.reset();
      if (ends[1].revents == POLLHUP) log_.reset();
      if (ends[2].revents != 0) reap();
      if (!gone_) check_times();
    }
    read_log();
    read_status();
  }

 private:
  void start();
  void put_down();
  void reap();
  void read_log();
  void read_status();
  void take_line(std::string_view line);
  void check_times();
  void ask_to_finish();
  void end_because(ChildEnding why, int signal);
  std::int64_t cpu_ticks() const;

  const ChildTask& task_;
  ChildReport& report_;
  pid_t pid_ = -1;
  Descriptor pid_file_, status_, log_;
  std::string pending_;
  bool gone_ = false, stopping_ = false, finishing_ = false;
  SteadyClock::time_point begun_ = SteadyClock::now(), last_life_ = begun_, stop_at_{}, second_{};
  int lines_this_second_ = 0;
  std::int64_t last_ticks_ = 0;
};

void Watch::start() {
  Pipe status = make_pipe(), log = make_pipe();
  const Descriptor request = make_request_file(task_.request);
  const Descriptor input = task_.input >= 0 ? high_copy(task_.input) : Descriptor();
  const Descriptor folder = task_.folder >= 0 ? high_copy(task_.folder) : Descriptor();
  pid_ = begin_child(task_,
                     {log.write_end.get(), input.get(), folder.get(), status.write_end.get(), request.get()});
  pid_file_.reset(::pidfd_open(pid_, 0));
  if (!pid_file_.valid()) {  // nobody would hear of its end
    const int error = errno;
    put_down();
    throw std::system_error(error, std::generic_category(), "pidfd_open");
  }
  status_ = std::move(status.read_end);
  log_ = std::move(log.read_end);
}

void Watch::put_down() {
  ::kill(-pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
}

void Watch::reap() {
  int status = 0;
  struct rusage usage {};
  if (::wait4(pid_, &status, WNOHANG, &usage) != pid_) return;
  gone_ = true;
  ::kill(-pid_, SIGKILL);  // whoever is left of its group; the sandbox lets nobody be
  report_.peak_rss = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  report_.cpu_ms = (usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1000 +
                   (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) / 1000;
  if (WIFSIGNALED(status))
    report_.signal = WTERMSIG(status);
  else
    report_.exit_status = WEXITSTATUS(status);
  if (!stopping_) report_.ending = WIFSIGNALED(status) ? ChildEnding::kSignalled : ChildEnding::kExited;
}

void Watch::read_log() {
  char buffer[4096];
  for (ssize_t got; (got = ::read(log_.get(), buffer, sizeof buffer)) > 0;)
    report_.log.append(buffer, std::min(static_cast<std::size_t>(got), kLogBytes - report_.log.size()));
}

void Watch::read_status() {
  char buffer[4096];
  for (ssize_t got; (got = ::read(status_.get(), buffer, sizeof buffer)) > 0;) {
    pending_.append(buffer, static_cast<std::size_t>(got));
    std::size_t begin = 0;
    for (std::size_t end; (end = pending_.find('\n', begin)) != std::string::npos; begin = end + 1)
      take_line(std::string_view(pending_).substr(begin, end - begin));
    pending_.erase(0, begin);
    if (pending_.size() > kStatusLineBytes) end_because(ChildEnding::kFlooded, SIGKILL), pending_.clear();
  }
}

void Watch::take_line(std::string_view line) {
  const auto now = SteadyClock::now();
  if (now - second_ >= std::chrono::seconds(1)) {
    second_ = now;
    lines_this_second_ = 0;
  }
  if (++lines_this_second_ > kLinesPerSecond) return end_because(ChildEnding::kFlooded, SIGKILL);
  last_life_ = now;
  if (const std::optional<WorkerMessage> message = message_from_line(line)) {
    if (!stopping_ && task_.on_message) task_.on_message(*message);
  } else {
    ++report_.bad_lines;
  }
}

/// Processor time used so far, in clock ticks of the kernel; 0 when it cannot be read.
std::int64_t Watch::cpu_ticks() const {
  const Descriptor file(::open(("/proc/" + std::to_string(pid_) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
  char text[1024];
  const ssize_t got = file.valid() ? ::read(file.get(), text, sizeof text - 1) : 0;
  if (got <= 0) return 0;
  text[got] = '\0';
  const char* after_name = std::strrchr(text, ')');
  long user = 0, system = 0;
  if (after_name == nullptr ||
      std::sscanf(after_name + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %ld", &user, &system) !=
          2)
    return 0;
  return user + system;
}

void Watch::check_times() {
  const auto now = SteadyClock::now();
  if (stopping_) {
    if (now >= stop_at_) ::kill(-pid_, SIGKILL);
    return;
  }
  if (task_.stop != nullptr && task_.stop->raised()) return end_because(ChildEnding::kStopped, SIGTERM);
  ask_to_finish();
  if (now - begun_ > task_.wall) return end_because(ChildEnding::kTimedOut, SIGTERM);
  if (now - last_life_ > task_.stall) {
    const std::int64_t ticks = cpu_ticks();
    if (ticks <= last_ticks_) return end_because(ChildEnding::kStalled, SIGTERM);
    last_ticks_ = ticks;
    last_life_ = now;
  }
}

/// Not before the child has said something: until then the signal would end it.
void Watch::ask_to_finish() {
  if (finishing_ || task_.enough == nullptr || !task_.enough->raised() || last_life_ == begun_) return;
  finishing_ = true;
  ::kill(pid_, SIGUSR1);
}

void Watch::end_because(ChildEnding why, int signal) {
  if (stopping_) return;
  stopping_ = true;
  report_.ending = why;
  stop_at_ = SteadyClock::now() + kPatience;
  ::kill(-pid_, signal);
}

}  // namespace

StopSignal::StopSignal() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!event_.valid()) refuse("eventfd");
}

void StopSignal::raise() {
  raised_ = true;
  const std::uint64_t one = 1;
  if (::write(event_.get(), &one, sizeof one) < 0) return;  // full means raised already
}

ChildReport run_child(const ChildTask& task) {
  ChildReport report;
  try {
    Watch watch(task, report);
    watch.run();
  } catch (const std::system_error& e) {
    report.ending = ChildEnding::kNotStarted;
    report.log += e.what();
    log_error("a child could not be started", {{"reason", e.what()}});
  }
  return report;
}

}  // namespace sheetform::server
