// The whole job service with many threads at once: submits, cancels, waits and looks while real processes
// run. What the thread sanitizer is for.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "server/base/identity.h"
#include "server/jobs/job_service.h"
#include "server/mapping/wire_parameters.h"
#include "sheetform_api/process.h"

namespace sheetform::server {
namespace {

class ServiceTest : public testing::Test {
 protected:
  ServiceTest()
      : folder_(std::filesystem::temp_directory_path() / ("sheetform-service-" + to_hex(random_bytes(6)))) {
    ServiceOptions options;
    options.data = folder_;
    options.sandbox = false;
    options.worker = SHEETFORM_FAKE_WORKER;
    options.limits.slots = 3;
    options.limits.free_bytes = 0;
    service_ = std::make_unique<JobService>(options);
    service_->start();
  }
  ~ServiceTest() override {
    service_.reset();
    std::filesystem::remove_all(folder_);
  }

  JobRecord submit(const std::string& name, const std::string& process = api::kDecompose) {
    const std::unique_ptr<Upload> upload = service_->begin_upload();
    upload->add("v 0 0 0\n# " + make_uuid());
    Submission s;
    s.name = name;
    s.process = process;
    s.parameters = process == api::kSweep ? understood_sweep_parameters(api::Json{{"e_max", {0.02, 0.05}}})
                                          : understood_parameters(api::Json::object());
    return service_->submit(*upload, s).job;
  }
  JobState end_of(JobRecord job) {
    while (!api::is_terminal(job.state)) job = service_->wait_for_change(job, true, std::chrono::seconds(60));
    return job.state;
  }

  std::filesystem::path folder_;
  std::unique_ptr<JobService> service_;
};

TEST_F(ServiceTest, ManyThreadsAtOnce) {
  constexpr int kThreads = 4, kJobs = 8;
  std::atomic<bool> ending{false};
  std::atomic<int> successful{0}, dismissed{0};
  std::thread looker([&] {
    std::uint64_t seen = service_->bus().newest();
    while (!ending) {
      service_->bus().wait("", seen, SteadyClock::now() + std::chrono::milliseconds(50));
      for (const JobRecord& job : service_->store().list(JobFilter{})) (void)service_->status(job);
      (void)service_->store().counts();
      (void)service_->running();
    }
  });
  std::vector<std::thread> users;
  for (int t = 0; t < kThreads; ++t)
    users.emplace_back([&, t] {
      for (int i = 0; i < kJobs; ++i) {
        const JobRecord job = submit((t + i) % 4 == 0 ? "work-400.obj" : "work-5.obj");
        if ((t + i) % 4 == 0) service_->dismiss(job);
        (end_of(service_->job(job.id, std::nullopt)) == JobState::kDismissed ? dismissed : successful)++;
      }
    });
  for (std::thread& u : users) u.join();
  ending = true;
  looker.join();
  EXPECT_EQ(successful, kThreads * kJobs * 3 / 4);
  EXPECT_EQ(dismissed, kThreads * kJobs / 4);
  service_->drain(std::chrono::seconds(5));
  EXPECT_EQ(service_->running(), 0);
}

TEST_F(ServiceTest, ASweepThatIsSaidToRunCanBeFinished) {
  for (int i = 0; i < 6; ++i) {
    const JobRecord job = submit("work-3.obj", api::kSweep);
    while (service_->store().find(job.id)->state == JobState::kAccepted) std::this_thread::yield();
    try {
      service_->finish(*service_->store().find(job.id));
    } catch (const Refusal& e) {
      FAIL() << e.problem().detail << " (round " << i << ')';
    }
    EXPECT_EQ(end_of(job), JobState::kSuccessful);
  }
}

TEST_F(ServiceTest, DrainWhileOthersSubmit) {
  std::atomic<int> accepted{0}, refused{0};
  std::vector<std::thread> users;
  for (int t = 0; t < 3; ++t)
    users.emplace_back([&] {
      for (int i = 0; i < 10; ++i) {
        try {
          service_->check_admission(0);
          (void)submit("work-5.obj");
          ++accepted;
        } catch (const Refusal& e) {
          EXPECT_EQ(e.problem().type, api::ProblemType::kDraining);
          ++refused;
        }
      }
    });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  service_->drain(std::chrono::seconds(1));
  for (std::thread& u : users) u.join();
  EXPECT_EQ(accepted + refused, 30);
  // What was accepted is there, ended or waiting for the next start.
  std::int64_t known = 0;
  for (const auto& [state, count] : service_->store().counts()) known += count;
  EXPECT_EQ(known, accepted);
}

}  // namespace
}  // namespace sheetform::server
