// Runs a fuzz target on every file of the folders given, on all their beginnings, and with each byte changed:
// what the default tests do with the corpora, without libFuzzer.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kThorough = 2000;  // larger seeds are cut and changed at every n-th byte only

void run(const std::string& bytes) {
  // A copy of exactly this size, so that a sanitizer sees the first byte that is read behind its end.
  const std::unique_ptr<std::uint8_t[]> copy(new std::uint8_t[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), copy.get());
  LLVMFuzzerTestOneInput(copy.get(), bytes.size());
}

void run_near(const std::string& seed) {
  run(seed);
  const std::size_t step = seed.size() / kThorough + 1;
  for (std::size_t at = 0; at < seed.size(); at += step) {
    run(seed.substr(0, at));
    for (const char other : {'\0', '\n', '9', '%', '\xff'}) {
      std::string changed = seed;
      changed[at] = other;
      run(changed);
    }
  }
}

}  // namespace

int main(int count, char** folders) {
  int files = 0;
  for (int i = 1; i < count; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(folders[i])) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::printf("%s\n", entry.path().filename().c_str());
      std::fflush(stdout);
      run_near({std::istreambuf_iterator<char>(in), {}});
      ++files;
    }
  std::printf("%d files\n", files);
  return files > 0 ? 0 : 1;
}
