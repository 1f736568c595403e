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

/// Number of the newest metadata schema.
int newest_schema();

}  // namespace sheetform::server
