#include "server/store/backup.h"

#include <SQLiteCpp/Backup.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <sstream>

#include "server/base/clock.h"
#include "server/base/digest.h"
#include "server/base/file_output.h"
#include "server/base/identity.h"
#include "server/store/sqlite.h"
#include "sheetform_api/json_text.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;
using api::Json;

constexpr int kTries = 3;
constexpr const char* kMetadata = "sheetform.db";
constexpr const char* kBlobs = "blobs.db";
constexpr const char* kTokens = "tokens.json";
constexpr const char* kManifest = "manifest.json";

/// What the metadata says must be there.
struct Named {
  std::int64_t jobs = 0;
  std::vector<std::string> inputs, results;  ///< digests
};

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

std::string file_digest(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse("the file " + path.string() + " cannot be read");
  Sha256 hash;
  std::string buffer(1 << 20, '\0');
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), in.gcount() > 0)
    hash.add(std::string_view(buffer).substr(0, static_cast<std::size_t>(in.gcount())));
  return hash.finish();
}

template <class F>
auto with_database(const fs::path& path, F&& use) {
  try {
    SQLite::Database db(path.string(), SQLite::OPEN_READONLY, 5000);
    return use(db);
  } catch (const SQLite::Exception& e) {
    refuse("the database " + path.string() + ": " + e.what());
  }
}

/// A copy of one moment, in one file without a log beside it.
void copy_database(const fs::path& from, const fs::path& to) {
  with_database(from, [&](SQLite::Database& source) {
    SQLite::Database target(to.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    SQLite::Backup backup(target, source);
    backup.executeStep(-1);
    target.exec("PRAGMA journal_mode=DELETE");  // one file that can be read wherever it lies
    return 0;
  });
}

Named named_by(const fs::path& metadata) {
  return with_database(metadata, [](SQLite::Database& db) {
    Named named;
    named.jobs = db.execAndGet("SELECT count(*) FROM job").getInt64();
    const auto collect = [&db](const char* query, std::vector<std::string>& list) {
      SQLite::Statement select(db, query);
      while (select.executeStep()) list.push_back(blob_of(select.getColumn(0)));
    };
    collect("SELECT DISTINCT input FROM job WHERE input IS NOT NULL ORDER BY input", named.inputs);
    collect("SELECT DISTINCT digest FROM output ORDER BY digest", named.results);
    return named;
  });
}

void check_database(const fs::path& path) {
  const std::string answer = with_database(
      path, [](SQLite::Database& db) { return db.execAndGet("PRAGMA integrity_check").getString(); });
  if (answer != "ok") refuse("the database " + path.string() + " is damaged: " + answer);
}

fs::path input_path(const fs::path& root, const std::string& digest) {
  const std::string hex = to_hex(digest);
  return root / "blobs" / "in" / hex.substr(0, 2) / hex;
}

/// Uploads never change: a second name for the same bytes will do, a copy where the disk is another one.
bool take_input(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path());
  if (fs::exists(to)) return true;
  fs::create_hard_link(from, to, error);
  if (error) fs::copy_file(from, to, error);
  return !error;
}

/// Digest of the chunks of a result, none when there is no first one.
std::optional<std::string> stored_digest(SQLite::Database& blobs, const std::string& digest) {
  SQLite::Statement select(blobs, "SELECT data FROM chunk WHERE digest = ? ORDER BY i");
  bind_blob(select, 1, digest);
  Sha256 hash;
  bool any = false;
  for (; select.executeStep(); any = true) hash.add(blob_of(select.getColumn(0)));
  if (!any) return std::nullopt;
  return hash.finish();
}

/// Whether all that the metadata names is there; with every byte looked at when `deep`.
std::optional<std::string> what_is_missing(const fs::path& root, const Named& named, bool deep) {
  for (const std::string& digest : named.inputs) {
    const fs::path path = input_path(root, digest);
    if (!fs::exists(path)) return "the upload " + to_hex(digest) + " is missing";
    if (deep && file_digest(path) != digest) return "the upload " + to_hex(digest) + " is damaged";
  }
  return with_database(root / kBlobs, [&](SQLite::Database& blobs) -> std::optional<std::string> {
    for (const std::string& digest : named.results) {
      const std::optional<std::string> found = stored_digest(blobs, digest);
      if (!found) return "the result " + to_hex(digest) + " is missing";
      if (*found != digest) return "the result " + to_hex(digest) + " is damaged";
    }
    return std::nullopt;
  });
}

BackupSummary summary_of(const Named& named) {
  return {named.jobs, static_cast<std::int64_t>(named.inputs.size()),
          static_cast<std::int64_t>(named.results.size())};
}

void write_manifest(const fs::path& root) {
  Json files = Json::object();
  for (const char* name : {kMetadata, kBlobs, kTokens})
    if (fs::exists(root / name)) files[name] = to_hex(file_digest(root / name));
  write_synced(root / kManifest,
               api::dump_pretty({{"made", api::rfc3339(now_us())}, {"format", 1}, {"sha256", files}}) + "\n");
}

void check_manifest(const fs::path& root) {
  std::ifstream in(root / kManifest, std::ios::binary);
  if (!in) refuse(root.string() + " is no backup: it has no " + kManifest);
  std::ostringstream text;
  text << in.rdbuf();
  const Json manifest = Json::parse(text.str(), nullptr, false);
  if (!manifest.is_object() || !manifest.contains("sha256"))
    refuse("the manifest of the backup is malformed");
  for (const auto& [name, digest] : manifest["sha256"].items())
    if (digest != Json(to_hex(file_digest(root / name))))
      refuse("the file " + name + " of the backup is damaged");
}

Named copy_once(const fs::path& data, const fs::path& target) {
  for (const char* name : {kMetadata, kBlobs}) fs::remove(target / name);
  copy_database(data / kMetadata, target / kMetadata);
  Named named = named_by(target / kMetadata);
  for (const std::string& digest : named.inputs)
    take_input(input_path(data, digest), input_path(target, digest));
  copy_database(data / kBlobs, target / kBlobs);
  return named;
}

struct Owner {
  uid_t user;
  gid_t group;
};

Owner owner_of(const fs::path& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) refuse("the folder " + folder.string() + " cannot be looked at");
  return {status.st_uid, status.st_gid};
}

/// What root has put into a folder of the server's user must be that user's, or the server could not read it.
void give_to(const Owner& owner, const fs::path& folder) {
  if (::geteuid() != 0) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (::lchown(entry.path().c_str(), owner.user, owner.group) != 0)
      refuse("cannot give " + entry.path().string() + " to the owner of " + folder.string());
}

bool is_empty_folder(const fs::path& path) { return !fs::exists(path) || fs::is_empty(path); }

}  // namespace

BackupSummary make_backup(const fs::path& data, const fs::path& target) {
  if (!fs::exists(data / kMetadata)) refuse(data.string() + " is no data folder of sheetform");
  if (!is_empty_folder(target)) refuse("the folder " + target.string() + " is not empty");
  make_folder_synced(target);
  for (int i = 0; i < kTries; ++i) {
    const Named named = copy_once(data, target);
    // Something may have been removed between the copies; then all is copied again.
    if (what_is_missing(target, named, false)) continue;
    if (fs::exists(data / kTokens)) fs::copy_file(data / kTokens, target / kTokens);
    write_manifest(target);
    sync_tree(target);
    return summary_of(named);
  }
  refuse("the store changed too fast to be copied; try again");
}

BackupSummary verify_backup(const fs::path& backup) {
  check_manifest(backup);
  check_database(backup / kMetadata);
  check_database(backup / kBlobs);
  const Named named = named_by(backup / kMetadata);
  if (const std::optional<std::string> missing = what_is_missing(backup, named, true)) refuse(*missing);
  return summary_of(named);
}

BackupSummary restore_backup(const fs::path& backup, const fs::path& data) {
  if (!is_empty_folder(data))
    refuse("the folder " + data.string() + " is not empty; move its content away first");
  const BackupSummary summary = verify_backup(backup);
  make_folder_synced(data);
  const Owner owner = owner_of(data);
  for (const char* name : {kMetadata, kBlobs, kTokens})
    if (fs::exists(backup / name)) fs::copy_file(backup / name, data / name);
  // Copies, not links: the backup stays whole whatever happens to the store.
  const Named named = named_by(backup / kMetadata);
  for (const std::string& digest : named.inputs) {
    fs::create_directories(input_path(data, digest).parent_path());
    fs::copy_file(input_path(backup, digest), input_path(data, digest));
  }
  give_to(owner, data);
  sync_tree(data);
  return summary;
}

}  // namespace sheetform::server
