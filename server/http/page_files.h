// The page for browsers: files built into the program, or read once from a folder.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "server/http/exchange.h"

namespace sheetform::server {

/// One file that was built in; made by server/cmake/page.cmake.
struct BuiltInFile {
  const char* path;  ///< as in the address, without leading slash
  const char* begin;
  const char* end;
};
/// The table ends with a null path.
extern const BuiltInFile kBuiltInFiles[];

class PageFiles {
 public:
  /// Those built in; with a folder, every regular file below it instead (at most 64 MiB). Throws
  /// std::runtime_error.
  explicit PageFiles(const std::filesystem::path& folder);

  bool empty() const { return files_.empty(); }
  /// The file at this path ("/" is index.html), with tag and security headers; none when there is none. A
  /// file of the same name with ".gz" is sent instead to whoever takes it.
  std::optional<Answer> find(const RequestHead& head) const;

 private:
  struct File {
    std::string content, tag;
  };
  void add(const std::string& path, std::string content);
  void add_folder(const std::filesystem::path& folder);
  std::map<std::string, File> files_;
};

}  // namespace sheetform::server
