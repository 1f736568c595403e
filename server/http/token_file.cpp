#include "server/http/token_file.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

#include "server/base/descriptor.h"
#include "server/base/digest.h"
#include "server/base/file_output.h"
#include "server/base/identity.h"
#include "server/base/log.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "sf_";
constexpr std::size_t kIdBytes = 6, kSecretBytes = 32;
constexpr const char* kScopes[] = {"read", "submit", "jobs:all", "admin"};

TokenRecord record_from(const api::Json& value) {
  TokenRecord r;
  r.name = value.at("name");
  r.id = value.at("id");
  r.scopes = value.at("scopes");
  r.created = value.at("created");
  if (!from_hex(value.at("sha256").get<std::string>(), r.hash) || r.hash.size() != 32)
    throw std::runtime_error("a digest is malformed");
  return r;
}

api::Json to_json(const TokenRecord& r) {
  return {{"name", r.name},
          {"id", r.id},
          {"scopes", r.scopes},
          {"created", r.created},
          {"sha256", to_hex(r.hash)}};
}

std::string id_of(const std::string& token) {
  const std::size_t end = token.find('_', kPrefix.size());
  if (token.rfind(kPrefix, 0) != 0 || end == std::string::npos) return {};
  return token.substr(kPrefix.size(), end - kPrefix.size());
}

/// Two commands at once must not lose each other's change.
Descriptor lock_beside(const fs::path& path) {
  fs::create_directories(path.parent_path());
  Descriptor lock(::open((path.string() + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock.valid() || ::flock(lock.get(), LOCK_EX) != 0) throw FileError("cannot lock " + path.string());
  return lock;
}

}  // namespace

bool is_token_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '_';
  });
}

std::optional<std::string> normal_scopes(const std::string& scopes) {
  std::string text = scopes, normal, word;
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  while (words >> word) {
    if (std::find(std::begin(kScopes), std::end(kScopes), word) == std::end(kScopes)) return std::nullopt;
    normal += (normal.empty() ? "" : " ") + word;
  }
  if (normal.empty()) return std::nullopt;
  return normal;
}

std::vector<TokenRecord> TokenFile::list() const {
  std::ifstream in(path_, std::ios::binary);
  if (!in) return {};
  std::ostringstream text;
  text << in.rdbuf();
  try {
    std::vector<TokenRecord> records;
    const api::Json file = api::Json::parse(text.str());
    for (const api::Json& value : file.at("tokens")) records.push_back(record_from(value));
    return records;
  } catch (const std::exception& e) {
    throw std::runtime_error("the file of tokens " + path_.string() + " is broken: " + e.what());
  }
}

void TokenFile::write(const std::vector<TokenRecord>& records) const {
  api::Json tokens = api::Json::array();
  for (const TokenRecord& r : records) tokens.push_back(to_json(r));
  const fs::path part = path_.string() + ".part";
  write_synced(part, api::dump_pretty({{"tokens", tokens}}) + "\n");
  fs::permissions(part, fs::perms::owner_read | fs::perms::owner_write);
  fs::rename(part, path_);
  sync_folder(path_.parent_path());  // a token that was taken away stays away
}

std::string TokenFile::add(const std::string& name, const std::string& scopes) {
  const Descriptor lock = lock_beside(path_);
  std::vector<TokenRecord> records = list();
  if (std::any_of(records.begin(), records.end(), [&](const TokenRecord& r) { return r.name == name; }))
    throw std::runtime_error("there is a token of the name " + name + " already");
  TokenRecord r;
  r.name = name;
  r.id = to_hex(random_bytes(kIdBytes));
  r.scopes = scopes;
  r.created = now_us();
  const std::string token = std::string(kPrefix) + r.id + "_" + to_hex(random_bytes(kSecretBytes));
  r.hash = sha256(token);
  records.push_back(r);
  write(records);
  return token;
}

bool TokenFile::remove(const std::string& name) {
  const Descriptor lock = lock_beside(path_);
  std::vector<TokenRecord> records = list();
  if (std::erase_if(records, [&](const TokenRecord& r) { return r.name == name; }) == 0) return false;
  write(records);
  return true;
}

TokenRegister::TokenRegister(fs::path path, std::string secret) : file_(path), path_(std::move(path)) {
  if (!secret.empty()) secret_ = TokenRecord{"secret", {}, "admin", sha256(secret), now_us()};
  records_ = file_.list();  // a broken file is told at the start, not at the first request
  std::error_code absent;
  changed_ = fs::last_write_time(path_, absent);
}

bool TokenRegister::any() const {
  const std::lock_guard lock(mutex_);
  return secret_ || !records_.empty();
}

void TokenRegister::reload_if_changed() {
  std::error_code absent;
  const fs::file_time_type changed = fs::last_write_time(path_, absent);
  if (changed == changed_) return;
  try {
    records_ = file_.list();
    changed_ = changed;
  } catch (const std::exception& e) {
    log_error("the old tokens stay in force", {{"reason", e.what()}});
  }
}

std::optional<TokenRecord> TokenRegister::find(const std::string& token) {
  const std::lock_guard lock(mutex_);
  reload_if_changed();
  const std::string hash = sha256(token), id = id_of(token);
  if (secret_ && equal_in_constant_time(hash, secret_->hash)) return secret_;
  for (const TokenRecord& r : records_)
    if (r.id == id && equal_in_constant_time(hash, r.hash)) return r;
  return std::nullopt;
}

}  // namespace sheetform::server
