// The schema of the metadata file, step by step. A released step never changes; new ones are added at the
// end.
#pragma once
#include "server/store/sqlite.h"

namespace sheetform::server {

inline constexpr int kApplicationId = 0x53464d31;  ///< "SFM1"

/// Brings the file to the newest schema, each step in a transaction of its own. Throws StoreError kRefused
/// when the file belongs to another program or to a newer version of this one.
void migrate_metadata(DatabaseFile& file);
void migrate_blobs(DatabaseFile& file);

/// What both do: brings the file from step user_version to the last of `steps`, statements each.
void run_migrations(DatabaseFile& file, const std::vector<const char*>& steps);

/// Number of the newest metadata schema.
int newest_schema();

}  // namespace sheetform::server
