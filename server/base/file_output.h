// Files that are complete or absent: written beside their place, synced, renamed into it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace sheetform::server {

/// Files and folders that this process makes from now on are its user's alone: meshes and results are nobody
/// else's business on a machine that many share.
void keep_files_private();

/// A file to be written, or a finished one in memory.
struct OutputFile {
  std::string name, media_type;
  std::string content;  ///< bytes
};

/// Thrown when the disk refuses; what() names file and reason.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A sync failed: what was written before may be lost, and trying again would not tell.
class SyncError : public FileError {
 public:
  using FileError::FileError;
};

/// Reads a whole file of at most `limit` bytes. Throws Error kUnreadableMesh (where: the path).
std::string read_input_file(const std::filesystem::path& path, std::uint64_t limit);

/// Makes the folder when needed, writes and syncs every file under a temporary name, then renames all of
/// them. When anything fails before the renames the folder keeps what it had. Throws FileError.
void write_files(const std::filesystem::path& folder, const std::vector<OutputFile>& files);

/// Makes the folder and those above it that are missing; each is there after a power cut too (also a folder
/// that was there, when the one above it may be read). Throws FileError, SyncError.
void make_folder_synced(const std::filesystem::path& folder);

/// What has been made, renamed or removed in the folder is so after a power cut too. Throws SyncError.
void sync_folder(const std::filesystem::path& folder);

/// Syncs every file and folder of `root`, which must hold nothing else. Throws SyncError.
void sync_tree(const std::filesystem::path& root);

/// Writes, syncs and closes one file with exactly this name, mode 0644. Throws FileError.
void write_synced(const std::filesystem::path& path, const std::string& content);

}  // namespace sheetform::server
