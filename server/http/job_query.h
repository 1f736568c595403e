// The query of the list of jobs, and its cursor.
#pragma once
#include "server/http/exchange.h"
#include "server/store/job_record.h"

namespace sheetform::server {

/// Reads every filter, the limit and the cursor. Throws Refusal kInvalidQueryParameter.
JobFilter job_filter(const Exchange& exchange);
/// The query of the next page (older jobs): the same filters, from after `last`.
std::string next_page_query(const Exchange& exchange, const JobRecord& last);
/// The query of the page before (newer jobs): the same filters, up to before `first`.
std::string previous_page_query(const Exchange& exchange, const JobRecord& first);

}  // namespace sheetform::server
