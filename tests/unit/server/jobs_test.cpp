// Verdicts, the worker's messages, the bus, the rate: the parts of the job service that need no process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "server/http/rate_limit.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/sandbox.h"

namespace sheetform::server {
namespace {

using Action = Verdict::Action;
using api::ProblemType;

struct Case {
  const char* name;
  ChildEnding ending;
  int exit_status, signal;
  bool told, has_result;
  StopReason reason;
  int used;  ///< crashes, errors and interruptions before
  Action action;
  ProblemType problem;
};

TEST(Priority, OnlyWhatAClientWaitsForGoesBeforeTheJobs) {
  const auto awaited = [](WorkerMode mode) {
    WorkerRequest request;
    request.mode = mode;
    return limits_of(request).awaited;
  };
  EXPECT_TRUE(awaited(WorkerMode::kInspect));
  EXPECT_TRUE(awaited(WorkerMode::kExport));
  EXPECT_FALSE(awaited(WorkerMode::kDecompose));
  EXPECT_FALSE(awaited(WorkerMode::kSweep));
}

constexpr std::uint64_t kRoom = std::uint64_t{1} << 40;

TEST(Verdict, Table) {
  const ServiceLimits limits;
  constexpr auto kNone = StopReason::kNone;
  const Case cases[] = {
      {"success", ChildEnding::kExited, 0, 0, false, true, kNone, 0, Action::kPublish,
       ProblemType::kInternal},
      {"exit 0 without result", ChildEnding::kExited, 0, 0, false, false, kNone, 0, Action::kFail,
       ProblemType::kAlgorithmFailed},
      {"refused", ChildEnding::kExited, 65, 0, true, false, kNone, 0, Action::kFail,
       ProblemType::kUnsupportedMesh},
      {"refused without words", ChildEnding::kExited, 65, 0, false, false, kNone, 0, Action::kFail,
       ProblemType::kAlgorithmFailed},
      {"our fault, told", ChildEnding::kExited, 70, 0, true, false, kNone, 0, Action::kFail,
       ProblemType::kUnsupportedMesh},
      {"memory", ChildEnding::kExited, 71, 0, false, false, kNone, 0, Action::kFail,
       ProblemType::kMemoryLimit},
      {"io", ChildEnding::kExited, 74, 0, false, false, kNone, 0, Action::kRequeue, ProblemType::kStorage},
      {"io, last start", ChildEnding::kExited, 74, 0, false, false, kNone, 4, Action::kFail,
       ProblemType::kStorage},
      {"crash", ChildEnding::kSignalled, 0, SIGSEGV, false, false, kNone, 0, Action::kRequeue,
       ProblemType::kWorkerCrashed},
      {"crash, third", ChildEnding::kSignalled, 0, SIGABRT, false, false, kNone, 2, Action::kFail,
       ProblemType::kWorkerCrashed},
      {"crash after a result", ChildEnding::kSignalled, 0, SIGSEGV, false, true, kNone, 2, Action::kFail,
       ProblemType::kWorkerCrashed},
      {"killed", ChildEnding::kSignalled, 0, SIGKILL, false, false, kNone, 2, Action::kFail,
       ProblemType::kMemoryLimit},
      {"processor time", ChildEnding::kSignalled, 0, SIGXCPU, false, false, kNone, 0, Action::kFail,
       ProblemType::kTimeLimit},
      {"wall time", ChildEnding::kTimedOut, 0, SIGKILL, false, false, kNone, 0, Action::kFail,
       ProblemType::kTimeLimit},
      {"stalled", ChildEnding::kStalled, 0, SIGTERM, false, false, kNone, 0, Action::kFail,
       ProblemType::kTimeLimit},
      {"flood", ChildEnding::kFlooded, 0, SIGKILL, false, false, kNone, 0, Action::kFail,
       ProblemType::kAlgorithmFailed},
      {"not started", ChildEnding::kNotStarted, 0, 0, false, false, kNone, 0, Action::kRequeue,
       ProblemType::kInternal},
      {"dismissed", ChildEnding::kStopped, 0, SIGTERM, false, true, StopReason::kDismissed, 0, Action::kDrop,
       ProblemType::kInternal},
      {"drained", ChildEnding::kStopped, 0, SIGTERM, false, false, StopReason::kDrain, 5, Action::kRequeue,
       ProblemType::kInternal},
      {"drained too often", ChildEnding::kStopped, 0, SIGTERM, false, false, StopReason::kDrain, 19,
       Action::kFail, ProblemType::kInternal}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    ChildReport report;
    report.ending = c.ending;
    report.exit_status = c.exit_status;
    report.signal = c.signal;
    std::optional<api::Problem> told;
    if (c.told) told.emplace().type = ProblemType::kUnsupportedMesh;
    JobRecord job;
    job.crashes = job.errors = job.interruptions = c.used;
    const Verdict v = judge_attempt(report, told, c.has_result, c.reason, job, "trace", limits, kRoom);
    EXPECT_EQ(v.action, c.action);
    if (v.action == Action::kFail || v.action == Action::kRequeue) {
      EXPECT_EQ(v.problem.type, c.problem);
    }
    EXPECT_FALSE(v.outcome.empty());
    if (c.reason == StopReason::kDrain) {
      EXPECT_EQ(v.delay, 0);
    }
  }
}

TEST(Verdict, AJobThatWatchesTheClockItselfRanOutOfTime) {
  ChildReport report;
  report.ending = ChildEnding::kExited;
  report.exit_status = 65;
  std::optional<api::Problem> told(std::in_place);
  told->type = ProblemType::kTimeLimit;
  ServiceLimits limits;
  limits.job_seconds = 7;
  const Verdict v = judge_attempt(report, told, false, StopReason::kNone, {}, "remove", limits, kRoom);
  EXPECT_EQ(v.action, Action::kFail);
  EXPECT_EQ(v.outcome, "time");
  EXPECT_EQ(v.problem.type, ProblemType::kTimeLimit);
  EXPECT_THAT(v.problem.detail, ::testing::HasSubstr("7 s"));
}

/// However often it has been tried: there may be room the next time.
TEST(Verdict, AFullDiskIsNoFaultOfTheJob) {
  ChildReport report;
  report.ending = ChildEnding::kExited;
  report.exit_status = 74;
  const ServiceLimits limits;
  JobRecord job;
  job.errors = limits.errors + 7;
  const auto judged = [&](std::uint64_t free_bytes) {
    return judge_attempt(report, std::nullopt, false, StopReason::kNone, job, "write", limits, free_bytes);
  };
  const Verdict full = judged(limits.result_bytes - 1);
  EXPECT_EQ(full.action, Action::kRequeue);
  EXPECT_EQ(full.counted_as, Requeue::kNoRoom);
  EXPECT_LE(full.delay, 5 * kSecond);
  EXPECT_GT(full.delay, 0);
  EXPECT_EQ(judged(limits.result_bytes).action, Action::kFail);
}

TEST(WorkerProtocol, RequestRoundTrips) {
  WorkerRequest r;
  r.mode = WorkerMode::kInspect;
  r.name = "a\"\n.obj";
  r.parameters = {{"e_max", 0.5}};
  r.threads = 3;
  r.memory = std::uint64_t{1} << 40;
  r.file_bytes = 7;
  r.cpu_seconds = 9;
  r.wall_seconds = 11;
  r.sandbox = false;
  r.parent = 11;
  EXPECT_EQ(worker_request_from(to_text(r)).parent, 11);
  EXPECT_EQ(to_text(worker_request_from(to_text(r))), to_text(r));
}

TEST(WorkerProtocol, MessagesRoundTrip) {
  WorkerMessage m;
  m.result = WorkerMessage::Result{{{"layout.svg", "image/svg+xml"}}, {{"patches", 2}}, {"note"}};
  std::string line = to_line(m);
  ASSERT_EQ(line.back(), '\n');
  line.pop_back();
  const std::optional<WorkerMessage> back = message_from_line(line);
  ASSERT_TRUE(back && back->result);
  EXPECT_EQ(back->result->files[0].name, "layout.svg");
  EXPECT_EQ(back->result->report, m.result->report);
}

TEST(WorkerProtocol, LiesAreDropped) {
  for (const char* line :
       {"", "{}", "[]", "7", "{\"progress\":5}", "{\"progress\":{\"fraction\":1.01}}",
        "{\"progress\":{\"fraction\":-0.1}}", "{\"progress\":{\"fraction\":\"x\"}}", "{\"result\":{}}",
        "{\"result\":{\"files\":[{\"name\":\"../a\",\"media\":\"a/b\"}]}}",
        "{\"result\":{\"files\":[{\"name\":\"A.SVG\",\"media\":\"a/b\"}]}}",
        "{\"result\":{\"files\":[{\"name\":\"a\",\"media\":\"a\"}]}}",
        "{\"result\":{\"files\":[{\"name\":\"a\",\"media\":\"a/b\\r\\nX: 1\"}]}}",
        "{\"result\":{\"files\":[5]}}", "{\"result\":{\"files\":[],\"report\":5}}", "{\"mesh\":5}",
        "{\"strange\":{}}", "{\"mesh\":{},\"probe\":{}}"})
    EXPECT_FALSE(message_from_line(line)) << line;
  EXPECT_FALSE(message_from_line(std::string(70000, ' ')));
}

TEST(WorkerProtocol, OutputNames) {
  for (const char* name : {"a", "layout.svg", "ruled.obj", "part-1_2.json"})
    EXPECT_TRUE(is_output_name(name)) << name;
  for (const char* name : {"", ".", "..", ".a", "-a", "a/b", "a\\b", "a b", "A", "a\n", "caf\xc3\xa9"})
    EXPECT_FALSE(is_output_name(name)) << name;
  EXPECT_FALSE(is_output_name(std::string(65, 'a')));
}

TEST(EventBus, WakesThoseWhoWaitForAJob) {
  EventBus bus;
  std::uint64_t seen = bus.newest();
  std::thread other([&] {
    bus.publish("b");
    bus.publish("a");
  });
  EXPECT_TRUE(bus.wait("a", seen, SteadyClock::now() + std::chrono::seconds(10)));
  other.join();
  EXPECT_FALSE(bus.wait("a", seen, SteadyClock::now()));
}

TEST(EventBus, NamesEachChangedJobOnce) {
  EventBus bus;
  const std::uint64_t before = bus.newest();
  for (const char* id : {"a", "b", "a", "c"}) bus.publish(id);
  const std::vector<JobChange> changes = *bus.changed_since(before);
  EXPECT_THAT(changes,
              testing::ElementsAre(testing::Field(&JobChange::job, "b"), testing::Field(&JobChange::job, "a"),
                                   testing::Field(&JobChange::job, "c")));
  EXPECT_THAT(*bus.changed_since(bus.newest()), testing::IsEmpty());
  for (int i = 0; i < 5000; ++i) bus.publish("x");
  EXPECT_FALSE(bus.changed_since(before));
}

TEST(EventBus, ToldAfterItsRemovalTooAJobIsRemoved) {
  EventBus bus;
  const std::uint64_t before = bus.newest();
  bus.publish("a");
  bus.publish_removed("a", 7);
  bus.publish("a");
  bus.publish("b");
  const std::vector<JobChange> changes = *bus.changed_since(before);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].job, "a");
  EXPECT_EQ(changes[0].removed_of, 7);
  EXPECT_FALSE(changes[1].removed_of);
}

TEST(EventBus, LiveProgressIsThinnedOut) {
  EventBus bus;
  const std::uint64_t before = bus.newest();
  for (int i = 0; i < 100; ++i) bus.progress("a", {1, i, "trace", ""}, false);
  EXPECT_LE(bus.newest() - before, 3u);
  EXPECT_EQ(bus.live("a")->percent, 99);
  bus.forget("a");
  EXPECT_FALSE(bus.live("a"));
}

TEST(EventBus, EndsAllWaits) {
  EventBus bus;
  bus.wake_all();
  std::uint64_t seen = 0;
  EXPECT_FALSE(bus.wait("", seen, SteadyClock::now() + std::chrono::hours(1)));
}

TEST(RateLimit, FillsEvenly) {
  RateLimit limit(60);
  const auto start = SteadyClock::now();
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(limit.take("a", start));
  EXPECT_FALSE(limit.take("a", start));
  EXPECT_TRUE(limit.take("b", start));
  EXPECT_FALSE(limit.take("a", start + std::chrono::milliseconds(900)));
  EXPECT_TRUE(limit.take("a", start + std::chrono::milliseconds(2000)));
  RateLimit none(0);
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(none.take("a", start));
}

}  // namespace
}  // namespace sheetform::server
