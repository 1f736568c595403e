// Copies of a whole store that fit together, made while the server runs, and their way back.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace sheetform::server {

struct BackupSummary {
  std::int64_t jobs = 0, inputs = 0, results = 0;  ///< results: distinct files
};

/// Copies the store below `data` into the new folder `target`: metadata, then what it names, then a manifest
/// with digests. The server may run. Throws StoreError and std::runtime_error; then nothing usable is in
/// `target`.
BackupSummary make_backup(const std::filesystem::path& data, const std::filesystem::path& target);

/// Looks at every byte of a backup: manifest, integrity of the databases, digest of every upload and result.
/// Throws std::runtime_error naming the first thing that is wrong.
BackupSummary verify_backup(const std::filesystem::path& backup);

/// Verifies, then makes `data` (absent or empty) a store again; by root, one of the folder's owner. Throws
/// std::runtime_error.
BackupSummary restore_backup(const std::filesystem::path& backup, const std::filesystem::path& data);

}  // namespace sheetform::server
