// What the store can say about itself when it fails.
#pragma once
#include <stdexcept>
#include <string>

namespace sheetform::server {

enum class StoreFailure {
  kFull,     ///< no space left; nothing was changed
  kBusy,     ///< another process holds the database; try again
  kDisk,     ///< the disk refused a read or a write; nothing was changed, it may go well the next time
  kRefused,  ///< a rule of the database was broken: our fault
};

class StoreError : public std::runtime_error {
 public:
  StoreError(StoreFailure kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  StoreFailure kind() const { return kind_; }

 private:
  StoreFailure kind_;
};

/// A sync that failed may have thrown dirty pages away, and damage spreads when it is written over: the
/// process ends at once with status 74, and the next start recovers. Logs first.
[[noreturn]] void end_after_storage_failure(const std::string& what);

}  // namespace sheetform::server
