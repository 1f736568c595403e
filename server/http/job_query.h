// The query of the list of jobs, and its cursor.
#pragma once
#include "server/http/exchange.h"
#include "server/store/job_record.h"

namespace sheetform::server {

/// Reads every filter, the limit and the cursor. Throws Refusal kInvalidQueryParameter.
JobFilter job_filter(const Exchange& exchange);
/// The query of the next page: the same filters, from after `last`.
std::string next_page_query(const Exchange& exchange, const JobRecord& last);

}  // namespace sheetform::server
