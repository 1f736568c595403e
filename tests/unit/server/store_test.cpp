#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <system_error>
#include <thread>

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/store/backup.h"
#include "server/store/blob_store.h"
#include "server/store/input_store.h"
#include "server/store/job_store.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("sheetform-store-" + to_hex(random_bytes(6)))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

NewJob new_job(std::int64_t principal = 0, const std::string& tag = {}) {
  NewJob job;
  job.id = make_uuid();
  job.principal = principal;
  job.process = "decompose";
  job.version = "1";
  job.parameters = "{}";
  job.tag = tag;
  job.input = sha256(job.id);
  job.input_bytes = 10;
  job.reuse_key = sha256("reuse " + job.id);
  job.created = now_us();
  job.expires = job.created + kDay;
  return job;
}

class JobStoreTest : public testing::Test {
 protected:
  Folder folder_;
  JobStore store_{folder_.path() / "sheetform.db"};
};

TEST_F(JobStoreTest, JobsAreClaimedInTheOrderOfArrival) {
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(store_.accept(new_job()).id);
  EXPECT_EQ(store_.queue_position(*store_.find(ids[3])), 4);
  for (const std::string& id : ids) EXPECT_EQ(store_.claim(now_us())->job.id, id);
  EXPECT_FALSE(store_.claim(now_us()));
}

TEST_F(JobStoreTest, PlacesInTheQueueFollowEveryChange) {
  std::vector<std::string> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(store_.accept(new_job()).id);
  const auto place = [&](int i) {
    return store_.queue_position(*store_.find(ids[static_cast<std::size_t>(i)]));
  };
  EXPECT_EQ(place(3), 4);
  store_.claim(now_us());
  EXPECT_EQ(place(3), 3);
  store_.dismiss(ids[1], now_us() + kDay);
  EXPECT_EQ(place(2), 1);
  EXPECT_EQ(place(3), 2);
  ids.push_back(store_.accept(new_job()).id);
  EXPECT_EQ(place(4), 3);
}

TEST_F(JobStoreTest, TheLineIsWhatTheRowsSayWhateverHappens) {
  std::mt19937 random(5);
  std::vector<std::int64_t> owners{0, store_.principal_id("anna"), store_.principal_id("ben")};
  std::vector<ClaimedJob> running;
  std::vector<std::string> ids;
  const auto any = [&random](std::size_t count) { return random() % count; };
  for (int step = 0; step < 400; ++step) {
    const std::size_t way = any(8);
    if (way < 3) ids.push_back(store_.accept(new_job(owners[any(3)])).id);
    if (way == 3)
      if (const auto claimed = store_.claim(now_us())) running.push_back(*claimed);
    if (way == 4 && !running.empty()) {
      const Microseconds later = now_us() - static_cast<Microseconds>(any(1'000'000));
      store_.requeue(running.back(), Requeue::kError, later, "again");
      running.pop_back();
    }
    if (way == 5 && !running.empty()) {
      store_.fail(running.back(), "{}", "no", Requeue::kError);
      running.pop_back();
    }
    if (way == 6 && !ids.empty()) store_.dismiss(ids[any(ids.size())], now_us() + kDay);
    if (way == 7 && !ids.empty()) store_.retry(ids[any(ids.size())], now_us() + kDay);
  }
  const auto check = [&](const JobStore& store) {
    JobFilter filter;
    filter.states = {JobState::kAccepted};
    filter.limit = 1000;
    std::vector<JobRecord> waiting = store.list(filter);
    ASSERT_GT(waiting.size(), 10U);
    std::sort(waiting.begin(), waiting.end(), [](const JobRecord& a, const JobRecord& b) {
      return std::pair(a.run_after, a.seq) < std::pair(b.run_after, b.seq);
    });
    for (std::size_t i = 0; i < waiting.size(); ++i)
      EXPECT_EQ(store.queue_position(waiting[i]), static_cast<std::int64_t>(i + 1));
    EXPECT_EQ(store.waiting(std::nullopt), static_cast<std::int64_t>(waiting.size()));
    for (const std::int64_t owner : owners)
      EXPECT_EQ(store.waiting(owner),
                std::count_if(waiting.begin(), waiting.end(),
                              [&](const JobRecord& job) { return job.principal == owner; }));
  };
  check(store_);
  store_.recover();
  check(store_);
  check(JobStore(folder_.path() / "sheetform.db"));
}

TEST_F(JobStoreTest, ManyAtOnceKeepTheLineRight) {
  constexpr int kThreads = 4, kJobs = 40;
  std::atomic<int> ended{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([this] {
      for (int j = 0; j < kJobs; ++j) {
        const JobRecord job = store_.accept(new_job());
        EXPECT_GE(store_.queue_position(job), 0);
        EXPECT_LE(store_.waiting(job.principal), kThreads * kJobs);
      }
    });
    threads.emplace_back([this, i, &ended] {
      for (int j = 0; j < kJobs / 2; ++j) {
        const auto claimed = store_.claim(now_us());
        if (!claimed) continue;
        if (i % 2 == 0) {
          store_.fail(*claimed, "{}", "no", Requeue::kError);
          ++ended;
        } else {
          store_.requeue(*claimed, Requeue::kError, now_us(), "again");
        }
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(store_.waiting(std::nullopt), kThreads * kJobs - ended);
  JobFilter filter;
  filter.states = {JobState::kAccepted};
  filter.limit = 1000;
  std::set<std::int64_t> places;
  for (const JobRecord& job : store_.list(filter)) places.insert(store_.queue_position(job));
  ASSERT_EQ(static_cast<int>(places.size()), kThreads * kJobs - ended);
  EXPECT_EQ(*places.begin(), 1);
  EXPECT_EQ(*places.rbegin(), kThreads * kJobs - ended);
}

TEST_F(JobStoreTest, PrincipalsTakeTurns) {
  const std::int64_t a = store_.principal_id("a"), b = store_.principal_id("b");
  EXPECT_EQ(store_.principal_id("a"), a);
  for (int i = 0; i < 4; ++i) store_.accept(new_job(a));
  for (int i = 0; i < 2; ++i) store_.accept(new_job(b));
  std::vector<std::int64_t> order;
  for (int i = 0; i < 6; ++i) order.push_back(store_.claim(now_us())->job.principal);
  EXPECT_THAT(order, testing::ElementsAre(a, b, a, b, a, a));
}

TEST_F(JobStoreTest, OnlyTheOwnerOfAnAttemptMayEndIt) {
  const std::string id = store_.accept(new_job()).id;
  const ClaimedJob first = *store_.claim(now_us());
  EXPECT_TRUE(store_.requeue(first, Requeue::kInterruption, now_us(), "again"));
  const ClaimedJob second = *store_.claim(now_us());
  EXPECT_EQ(second.job.attempt, 2);
  EXPECT_FALSE(store_.succeed(first, {{"a", "text/plain", sha256("a"), 1}}, "{}", ""));
  EXPECT_FALSE(store_.fail(first, "{}", "", Requeue::kError));
  EXPECT_FALSE(store_.report_progress(first, 50, "trace", ""));
  EXPECT_TRUE(store_.outputs(second.job.seq).empty());
  EXPECT_TRUE(store_.succeed(second, {{"a", "text/plain", sha256("a"), 1}}, "{}", ""));
  EXPECT_FALSE(store_.succeed(second, {}, "{}", ""));
  EXPECT_EQ(store_.outputs(second.job.seq).size(), 1u);
  EXPECT_EQ(store_.find(id)->state, JobState::kSuccessful);
}

TEST_F(JobStoreTest, ADismissedJobTakesNoResult) {
  const std::string id = store_.accept(new_job()).id;
  const ClaimedJob claimed = *store_.claim(now_us());
  EXPECT_EQ(store_.dismiss(id, now_us() + kDay), DismissOutcome::kDismissed);
  EXPECT_FALSE(store_.succeed(claimed, {{"a", "text/plain", sha256("a"), 1}}, "{}", ""));
  EXPECT_EQ(store_.find(id)->state, JobState::kDismissed);
  EXPECT_EQ(store_.dismiss(id, 0), DismissOutcome::kRemoved);
  EXPECT_EQ(store_.dismiss(id, 0), DismissOutcome::kNoSuchJob);
}

TEST_F(JobStoreTest, HeldBackJobsWaitForTheirTime) {
  store_.accept(new_job());
  const ClaimedJob claimed = *store_.claim(now_us());
  const Microseconds later = now_us() + 300 * kSecond;
  store_.requeue(claimed, Requeue::kCrash, later, "later");
  EXPECT_FALSE(store_.claim(now_us()));
  const std::optional<ClaimedJob> again = store_.claim(later);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->job.crashes, 1);
}

TEST_F(JobStoreTest, AStartCountsForItsReasonAlone) {
  store_.accept(new_job());
  for (const Requeue reason : {Requeue::kCrash, Requeue::kError, Requeue::kInterruption, Requeue::kNoRoom}) {
    const ClaimedJob claimed = *store_.claim(now_us());
    ASSERT_TRUE(store_.requeue(claimed, reason, now_us(), "again"));
  }
  const JobRecord job = store_.claim(now_us())->job;
  EXPECT_EQ(std::make_tuple(job.attempt, job.crashes, job.errors, job.interruptions),
            std::make_tuple(5, 1, 1, 1));
}

TEST_F(JobStoreTest, AClockThatWasPutBackHoldsNobodyBack) {
  store_.accept(new_job());
  store_.accept(new_job());
  EXPECT_TRUE(store_.claim(now_us() - 3600 * kSecond));
  EXPECT_TRUE(store_.claim(now_us() + 3600 * kSecond));
}

TEST_F(JobStoreTest, EventsAreNumberedWithoutGaps) {
  const JobRecord job = store_.accept(new_job());
  const ClaimedJob claimed = *store_.claim(now_us());
  for (int p = 0; p < 100; p += 10) store_.report_progress(claimed, p, "trace", "");
  store_.fail(claimed, R"({"status":422})", "no", Requeue::kError);
  const std::vector<JobEvent> events = store_.events_after(job.seq, 0);
  ASSERT_EQ(events.size(), 13u);
  for (std::size_t i = 0; i < events.size(); ++i)
    EXPECT_EQ(events[i].number, static_cast<std::int64_t>(i + 1));
  EXPECT_EQ(events.front().state, JobState::kAccepted);
  EXPECT_EQ(events.back().state, JobState::kFailed);
  EXPECT_EQ(store_.events_after(job.seq, 12).size(), 1u);
  EXPECT_EQ(store_.find(job.id)->last_event, 13);
}

TEST_F(JobStoreTest, RecoveryPutsRunningJobsBack) {
  const std::string id = store_.accept(new_job()).id;
  store_.accept(new_job());
  (void)store_.claim(now_us());
  EXPECT_EQ(store_.recover(), 1);
  EXPECT_EQ(store_.find(id)->state, JobState::kAccepted);
  EXPECT_EQ(store_.find(id)->interruptions, 1);
  EXPECT_EQ(store_.claim(now_us())->job.id, id);
}

TEST_F(JobStoreTest, RetryStartsAfresh) {
  const std::string id = store_.accept(new_job()).id;
  EXPECT_FALSE(store_.retry(id, 0));
  const ClaimedJob claimed = *store_.claim(now_us());
  store_.fail(claimed, R"({"status":500})", "no", Requeue::kCrash);
  EXPECT_TRUE(store_.retry(id, now_us() + kDay));
  const JobRecord job = *store_.find(id);
  EXPECT_EQ(job.state, JobState::kAccepted);
  EXPECT_EQ(job.crashes, 0);
  EXPECT_EQ(job.problem, "");
  EXPECT_FALSE(store_.retry("nobody", 0));
}

TEST_F(JobStoreTest, ReuseCopiesAResultAndOutlivesItsSource) {
  NewJob first = new_job();
  store_.accept(first);
  const ClaimedJob claimed = *store_.claim(now_us());
  store_.succeed(claimed, {{"a", "text/plain", sha256("a"), 1}, {"b", "text/plain", sha256("b"), 2}},
                 R"({"patches":1})", "");
  NewJob second = new_job();
  second.reuse_key = first.reuse_key;
  ASSERT_EQ(store_.find_reusable(0, first.reuse_key)->id, first.id);
  EXPECT_FALSE(store_.find_reusable(store_.principal_id("other"), first.reuse_key));
  const std::optional<JobRecord> job = store_.accept_reused(second, first.id);
  ASSERT_TRUE(job);
  EXPECT_EQ(job->state, JobState::kSuccessful);
  EXPECT_EQ(job->report, R"({"patches":1})");
  EXPECT_EQ(job->reused_from, first.id);
  EXPECT_EQ(store_.remove(first.id), first.principal);
  EXPECT_FALSE(store_.remove(first.id));
  EXPECT_EQ(store_.outputs(job->seq).size(), 2u);
  EXPECT_EQ(store_.outputs(job->seq)[1].name, "b");
  EXPECT_TRUE(store_.unused_blobs(now_us() + 1, 10).size() == 1);  // the first job's upload
  EXPECT_FALSE(store_.accept_reused(new_job(), first.id));
}

TEST_F(JobStoreTest, APartOfAResultIsReusedUnderItsOwnNames) {
  NewJob first = new_job();
  store_.accept(first);
  const std::vector<StoredOutput> outputs{{"sweep.json", "text/plain", sha256("s"), 1},
                                          {"0.02-a", "text/plain", sha256("a"), 1},
                                          {"0.025-a", "text/plain", sha256("b"), 2}};
  store_.succeed(*store_.claim(now_us()), outputs, R"({"curve":[]})", "");
  const std::optional<JobRecord> job =
      store_.accept_reused(new_job(), first.id, {"0.02-", R"({"patches":7})"});
  ASSERT_TRUE(job);
  EXPECT_EQ(job->report, R"({"patches":7})");
  ASSERT_EQ(store_.outputs(job->seq).size(), 1u);
  EXPECT_EQ(store_.outputs(job->seq)[0].name, "a");
  EXPECT_EQ(store_.outputs(job->seq)[0].digest, sha256("a"));
  EXPECT_FALSE(store_.accept_reused(new_job(), first.id, {"0.03-", "{}"}));
}

TEST_F(JobStoreTest, IdempotencyIsKeptAndForgotten) {
  NewJob job = new_job();
  job.idempotency_key = "k";
  job.route = "/r";
  job.fingerprint = "f";
  store_.accept(job);
  EXPECT_EQ(store_.find_idempotency(0, "/r", "k")->job, job.id);
  EXPECT_FALSE(store_.find_idempotency(1, "/r", "k"));
  EXPECT_FALSE(store_.find_idempotency(0, "/q", "k"));
  store_.forget_idempotency(now_us() + 1);
  EXPECT_FALSE(store_.find_idempotency(0, "/r", "k"));
}

TEST_F(JobStoreTest, ListsByFilterAndPage) {
  std::vector<std::string> ids;
  for (int i = 0; i < 9; ++i) ids.push_back(store_.accept(new_job(0, i % 3 == 0 ? "x" : "y")).id);
  JobFilter filter;
  filter.tag = "x";
  EXPECT_EQ(store_.list(filter).size(), 3u);
  filter = JobFilter();
  filter.limit = 4;
  std::vector<std::string> seen;
  for (;;) {
    const std::vector<JobRecord> page = store_.list(filter);
    for (const JobRecord& j : page) seen.push_back(j.id);
    if (page.size() < 4) break;
    filter.after = {page.back().created, page.back().id};
  }
  std::reverse(ids.begin(), ids.end());
  EXPECT_EQ(seen, ids);
  filter = JobFilter();
  filter.states = {JobState::kRunning};
  EXPECT_TRUE(store_.list(filter).empty());
}

TEST_F(JobStoreTest, ListsByStateAsByLookingAtEveryJob) {
  const std::int64_t other = store_.principal_id("other");
  for (int i = 0; i < 40; ++i) store_.accept(new_job(i % 2 == 0 ? 0 : other, "x"));
  for (int i = 0; i < 20; ++i) {
    const ClaimedJob claimed = *store_.claim(now_us());
    if (i % 3 == 0) store_.dismiss(claimed.job.id, now_us() + kDay);
    if (i % 3 == 1) store_.requeue(claimed, Requeue::kError, now_us() + kDay, "later");
  }
  JobFilter filter;
  filter.limit = 100;
  const std::vector<JobRecord> all = store_.list(filter);
  const std::array states{JobState::kAccepted, JobState::kRunning, JobState::kDismissed, JobState::kFailed};
  for (unsigned chosen = 1; chosen < 16; ++chosen)
    for (const bool own : {false, true}) {
      filter = JobFilter();
      filter.limit = 5;
      filter.after = {all[10].created, all[10].id};
      if (own) filter.principal = other;
      for (std::size_t s = 0; s < states.size(); ++s)
        if ((chosen >> s & 1U) != 0) filter.states.push_back(states[s]);
      std::vector<std::string> expected, listed;
      for (std::size_t i = 11; i < all.size() && expected.size() < 5; ++i)
        if (std::count(filter.states.begin(), filter.states.end(), all[i].state) > 0 &&
            (!own || all[i].principal == other))
          expected.push_back(all[i].id);
      for (const JobRecord& job : store_.list(filter)) listed.push_back(job.id);
      EXPECT_EQ(listed, expected) << chosen << own;
    }
}

TEST_F(JobStoreTest, TextsOfStrangersAreOnlyTexts) {
  const std::string evil = "'; DROP TABLE job; --";
  NewJob job = new_job(0, evil);
  job.input_name = evil;
  store_.accept(job);
  EXPECT_FALSE(store_.find(evil));
  JobFilter filter;
  filter.tag = evil;
  EXPECT_EQ(store_.list(filter).size(), 1u);
}

TEST_F(JobStoreTest, ExpiredJobsGoAndLeaveTheirContentUnused) {
  NewJob job = new_job();
  job.principal = store_.principal_id("somebody");
  job.expires = now_us() - 1;
  store_.accept(job);
  EXPECT_TRUE(store_.remove_expired(now_us(), 10).empty());  // it still waits
  const ClaimedJob claimed = *store_.claim(now_us());
  store_.succeed(claimed, {{"a", "text/plain", sha256("a"), 1}}, "{}", "");
  const std::vector<RemovedJob> gone = store_.remove_expired(now_us(), 10);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_EQ(gone[0].id, job.id);
  EXPECT_EQ(gone[0].principal, job.principal);
  EXPECT_EQ(store_.unused_blobs(now_us() + 1, 10).size(), 2u);
  EXPECT_TRUE(store_.remove_blob_row(job.input));
  EXPECT_FALSE(store_.knows_blob(job.input));
}

TEST_F(JobStoreTest, EverythingIsThereAfterReopening) {
  const std::string id = store_.accept(new_job()).id;
  const JobStore again(folder_.path() / "sheetform.db");
  EXPECT_EQ(again.find(id)->id, id);
  EXPECT_EQ(again.check_integrity(), "");
}

TEST(BlobStore, RoundTripsAndReadsAnywhere) {
  const Folder folder;
  BlobStore blobs(folder.path() / "blobs.db");
  std::mt19937 rng(3);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{262143}, std::size_t{262144},
                                 std::size_t{262145}, std::size_t{5'000'000}}) {
    std::string content(size, '\0');
    for (char& c : content) c = static_cast<char>(rng());
    const fs::path path = folder.path() / "file";
    std::ofstream(path, std::ios::binary) << content;
    const Descriptor file(::open(path.c_str(), O_RDONLY));
    const std::string digest = blobs.put_file(file.get(), size);
    EXPECT_EQ(digest, sha256(content));
    EXPECT_EQ(blobs.put_file(file.get(), size), digest);  // again
    EXPECT_TRUE(blobs.has(digest));
    EXPECT_EQ(blobs.read(digest, 0, size + 10), content);
    for (int i = 0; i < 20 && size > 0; ++i) {
      const std::uint64_t at = rng() % size, count = rng() % 600'000;
      EXPECT_EQ(blobs.read(digest, at, count), content.substr(at, count));
    }
    EXPECT_EQ(blobs.read(digest, size, 10), "");
    blobs.drop(digest);
    EXPECT_FALSE(blobs.has(digest));
  }
  EXPECT_TRUE(blobs.digests("", 10).empty());
}

TEST(BlobStore, AFileThatIsShorterThanToldIsRefused) {
  const Folder folder;
  BlobStore blobs(folder.path() / "blobs.db");
  const fs::path path = folder.path() / "file";
  std::ofstream(path) << "abc";
  const Descriptor file(::open(path.c_str(), O_RDONLY));
  EXPECT_THROW((void)blobs.put_file(file.get(), 4), std::runtime_error);
}

TEST(InputStore, KeepsOnceUnderTheDigest) {
  const Folder folder;
  InputStore inputs(folder.path());
  const std::string content(1'000'000, 'm');
  for (int i = 0; i < 2; ++i) {
    Upload upload(inputs.spool());
    upload.add(content.substr(0, 10));
    upload.add(content.substr(10));
    EXPECT_EQ(upload.finish(), sha256(content));
    inputs.keep(upload);
  }
  EXPECT_TRUE(fs::is_empty(inputs.spool()));
  const Descriptor file = inputs.open(sha256(content));
  ASSERT_TRUE(file.valid());
  std::string back(content.size() + 1, '\0');
  EXPECT_EQ(::read(file.get(), back.data(), back.size()), static_cast<ssize_t>(content.size()));
  EXPECT_TRUE(inputs.older_than(now_us() - kHour, 10).empty());
  EXPECT_EQ(inputs.older_than(now_us() + kHour, 10), std::vector<std::string>{sha256(content)});
  inputs.drop(sha256(content));
  EXPECT_FALSE(inputs.open(sha256(content)).valid());
}

TEST(InputStore, TellsAMeshThatIsGoneFromALackOfDescriptors) {
  const Folder folder;
  InputStore inputs(folder.path());
  Upload upload(inputs.spool());
  upload.add("abc");
  inputs.keep(upload);
  rlimit usual{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &usual), 0);
  const rlimit none{0, usual.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  EXPECT_THROW((void)inputs.open(sha256("abc")), std::system_error);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &usual), 0);
  EXPECT_TRUE(inputs.open(sha256("abc")).valid());
  EXPECT_FALSE(inputs.open(sha256("abd")).valid());
}

TEST(InputStore, KeepsWhereTheFoldersCouldNotBeMadeAtTheStart) {
  const Folder folder;
  InputStore inputs(folder.path());
  for (const fs::directory_entry& part : fs::directory_iterator(folder.path() / "blobs" / "in"))
    fs::remove(part.path());  // as when the disk was full
  Upload upload(inputs.spool());
  upload.add("abc");
  inputs.keep(upload);
  EXPECT_TRUE(inputs.open(sha256("abc")).valid());
}

TEST(InputStore, AnUploadThatIsLeftAloneLeavesNothing) {
  const Folder folder;
  InputStore inputs(folder.path());
  {
    Upload upload(inputs.spool());
    upload.add("abc");
  }
  EXPECT_TRUE(fs::is_empty(inputs.spool()));
  std::ofstream(inputs.spool() / "left.part") << "x";
  const InputStore again(folder.path());
  EXPECT_TRUE(fs::is_empty(inputs.spool()));
}

}  // namespace
}  // namespace sheetform::server
