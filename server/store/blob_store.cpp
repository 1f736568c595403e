#include "server/store/blob_store.h"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "server/base/digest.h"
#include "server/store/migrations.h"
#include "server/store/sqlite.h"

namespace sheetform::server {
namespace {

constexpr std::uint64_t kChunk = 256 * 1024;
constexpr std::uint64_t kChunksPerCommit = 16;  // 4 MiB: readers and other writers wait at most some 30 ms
constexpr int kChunksPerDelete = 64;

/// Reads exactly `count` bytes at `offset`.
std::string read_at(int fd, std::uint64_t offset, std::uint64_t count) {
  std::string bytes(count, '\0');
  for (std::uint64_t done = 0; done < count;) {
    const ssize_t got = ::pread(fd, bytes.data() + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw std::runtime_error("a file of the result ended early");
    done += static_cast<std::uint64_t>(got);
  }
  return bytes;
}

std::string digest_of_file(int fd, std::uint64_t bytes) {
  Sha256 hash;
  for (std::uint64_t at = 0; at < bytes; at += kChunk)
    hash.add(read_at(fd, at, std::min(kChunk, bytes - at)));
  return hash.finish();
}

}  // namespace

struct BlobStore::State {
  explicit State(const std::filesystem::path& path) : file(path, "PRAGMA auto_vacuum=INCREMENTAL;") {
    migrate_blobs(file);
  }
  DatabaseFile file;
};

BlobStore::BlobStore(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
BlobStore::~BlobStore() = default;

std::string BlobStore::put_file(int fd, std::uint64_t bytes) {
  const std::string digest = digest_of_file(fd, bytes);
  Sha256 written;
  const std::uint64_t chunks = std::max<std::uint64_t>(1, (bytes + kChunk - 1) / kChunk);
  for (std::uint64_t first = 0; first < chunks; first += kChunksPerCommit) {
    state_->file.write([&](SQLite::Database& db) {
      SQLite::Statement insert(db,
                               "INSERT INTO chunk(digest, i, data) VALUES(?, ?, ?) ON CONFLICT DO NOTHING");
      for (std::uint64_t i = first; i < std::min(chunks, first + kChunksPerCommit); ++i) {
        const std::string data = read_at(fd, i * kChunk, std::min(kChunk, bytes - i * kChunk));
        written.add(data);
        bind_blob(insert, 1, digest);
        insert.bind(2, static_cast<std::int64_t>(i));
        bind_blob(insert, 3, data);
        insert.exec();
        insert.reset();
      }
    });
  }
  if (written.finish() != digest)
    throw std::runtime_error("a file of the result changed while it was stored");
  return digest;
}

std::string BlobStore::read(const std::string& digest, std::uint64_t offset, std::uint64_t count) const {
  std::string bytes;
  while (bytes.size() < count) {
    const std::uint64_t at = offset + bytes.size();
    const std::string chunk = state_->file.read([&](SQLite::Database& db) {
      SQLite::Statement select(db, "SELECT data FROM chunk WHERE digest = ? AND i = ?");
      bind_blob(select, 1, digest);
      select.bind(2, static_cast<std::int64_t>(at / kChunk));
      return select.executeStep() ? blob_of(select.getColumn(0)) : std::string();
    });
    const std::uint64_t skip = at % kChunk;
    if (skip >= chunk.size()) break;
    bytes.append(chunk, skip, count - bytes.size());
  }
  return bytes;
}

bool BlobStore::has(const std::string& digest) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(db, "SELECT 1 FROM chunk WHERE digest = ? AND i = 0");
    bind_blob(select, 1, digest);
    return select.executeStep();
  });
}

void BlobStore::drop(const std::string& digest) {
  for (int removed = kChunksPerDelete; removed == kChunksPerDelete;) {
    removed = state_->file.write([&](SQLite::Database& db) {
      // From the end, so that what is left of a half-removed blob is never taken for a whole one's beginning
      // and end.
      SQLite::Statement remove(db,
                               "DELETE FROM chunk WHERE rowid IN "
                               "(SELECT rowid FROM chunk WHERE digest = ? ORDER BY i DESC LIMIT ?)");
      bind_blob(remove, 1, digest);
      remove.bind(2, kChunksPerDelete);
      return remove.exec();
    });
  }
}

std::vector<std::string> BlobStore::digests(const std::string& after, int limit) const {
  return state_->file.read([&](SQLite::Database& db) {
    SQLite::Statement select(db,
                             "SELECT DISTINCT digest FROM chunk WHERE digest > ? ORDER BY digest LIMIT ?");
    bind_blob(select, 1, after);
    select.bind(2, limit);
    std::vector<std::string> list;
    while (select.executeStep()) list.push_back(blob_of(select.getColumn(0)));
    return list;
  });
}

void BlobStore::shrink() { state_->file.run_outside_transaction("PRAGMA incremental_vacuum(1024)"); }

}  // namespace sheetform::server
