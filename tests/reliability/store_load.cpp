// Fills a store with jobs and measures how long a slot waits for the next one; T2 and T10 run it.
//   store_load FOLDER ENDED WAITING CLAIMS [RESULTS]
// Makes the store in FOLDER, with RESULTS jobs whose result has a MiB, ENDED jobs that were cancelled and
// WAITING ones of 50 users, claims CLAIMS of these one after the other and prints the seconds that each
// took, one a line.
#include <sys/mman.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "server/base/descriptor.h"
#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/store/blob_store.h"
#include "server/store/job_store.h"

namespace sheetform::server {
namespace {

constexpr int kUsers = 50;
constexpr std::size_t kResultBytes = 1 << 20;
constexpr int kWriters = 64;  // they share transactions

NewJob new_job(std::int64_t principal) {
  NewJob job;
  job.id = make_uuid();
  job.principal = principal;
  job.process = "decompose";
  job.version = "1";
  job.parameters = R"({"e_max":0.02,"seed":0})";
  job.input = sha256(job.id);
  job.input_bytes = 1000;
  job.input_name = "lamp.stl";
  job.input_info = R"({"format":"stl","vertices":500,"faces":996,"name":"lamp.stl","bytes":1000})";
  job.reuse_key = sha256("reuse " + job.id);
  job.created = now_us();
  job.expires = job.created + 30 * kDay;
  return job;
}

/// Calls make(i) for all i below `count`, by many threads.
template <class Make>
void make_all(int count, Make&& make) {
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kWriters; ++t)
    threads.emplace_back([&] {
      for (int i; (i = next++) < count;) make(i);
    });
  for (std::thread& t : threads) t.join();
}

/// A successful job whose only file is like no other.
void make_result(JobStore& store, BlobStore& blobs) {
  store.accept(new_job(0));
  const ClaimedJob claimed = store.claim(now_us()).value();
  std::string bytes;
  for (std::string part = claimed.job.id; bytes.size() < kResultBytes; bytes += part) part = sha256(part);
  bytes.resize(kResultBytes);
  const Descriptor file(::memfd_create("result", MFD_CLOEXEC));
  if (!file.valid() || !write_whole(file.get(), bytes)) std::abort();
  const StoredOutput output{"layout.svg", "image/svg+xml", blobs.put_file(file.get(), bytes.size()),
                            static_cast<std::int64_t>(bytes.size())};
  if (!store.succeed(claimed, {output}, "{}", "1 part")) std::abort();
}

void run(const std::filesystem::path& folder, int ended, int waiting, int claims, int results) {
  std::filesystem::create_directories(folder);
  JobStore store(folder / "sheetform.db");
  BlobStore blobs(folder / "blobs.db");
  for (int i = 0; i < results; ++i) make_result(store, blobs);
  std::vector<std::int64_t> users;
  for (int i = 0; i < kUsers; ++i) users.push_back(store.principal_id("user " + std::to_string(i)));
  make_all(ended, [&](int) { store.dismiss(store.accept(new_job(0)).id, now_us() + 30 * kDay); });
  make_all(waiting, [&](int i) { store.accept(new_job(users[static_cast<std::size_t>(i % kUsers)])); });
  for (int i = 0; i < claims; ++i) {
    const auto begun = SteadyClock::now();
    if (!store.claim(now_us())) std::abort();
    std::printf("%.6f\n", std::chrono::duration<double>(SteadyClock::now() - begun).count());
  }
}

}  // namespace
}  // namespace sheetform::server

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) return 64;
  sheetform::server::run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]),
                         argc == 6 ? std::atoi(argv[5]) : 0);
  return 0;
}
