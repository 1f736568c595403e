// The tokens that open the service: names, scopes and digests in one file, never the tokens themselves. A
// running server notices changes of the file by itself.
#pragma once
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"

namespace sheetform::server {

struct TokenRecord {
  std::string name, id, scopes;
  std::string hash;  ///< SHA-256 of the token
  Microseconds created = 0;
};

class TokenFile {
 public:
  /// The file need not exist.
  explicit TokenFile(std::filesystem::path path) : path_(std::move(path)) {}

  /// All records. Throws std::runtime_error when the file is broken.
  std::vector<TokenRecord> list() const;
  /// Makes a token for a new name, and says it: it is nowhere else. Throws std::runtime_error when the name
  /// is taken.
  std::string add(const std::string& name, const std::string& scopes);
  /// False when there is no such name.
  bool remove(const std::string& name);

 private:
  void write(const std::vector<TokenRecord>& records) const;
  std::filesystem::path path_;
};

/// Names of tokens: letters, digits, dot, dash, underscore.
bool is_token_name(const std::string& name);
/// Scopes separated by spaces or commas, in the form that records keep; none when one is unknown.
std::optional<std::string> normal_scopes(const std::string& scopes);

/// What a server checks tokens against.
class TokenRegister {
 public:
  /// secret: a token that counts besides those of the file (from --token-file); may be empty.
  TokenRegister(std::filesystem::path path, std::string secret);
  bool any() const;
  /// The record of a token, none when it is wrong. The time does not tell how wrong.
  std::optional<TokenRecord> find(const std::string& token);

 private:
  void reload_if_changed();
  TokenFile file_;
  std::filesystem::path path_;
  mutable std::mutex mutex_;
  std::filesystem::file_time_type changed_{};
  std::vector<TokenRecord> records_;
  std::optional<TokenRecord> secret_;
};

}  // namespace sheetform::server
