// The three forms of an execution request become one submission and one upload.
#pragma once
#include <memory>

#include "server/http/exchange.h"
#include "server/jobs/job_service.h"

namespace sheetform::server {

struct UploadRequest {
  std::unique_ptr<Upload> upload;
  Submission submission;
};

/// Reads parameters and body. Decides by the Content-Type, before a byte of the body is read. Throws Refusal,
/// BodyError, Error kInvalidParameter.
UploadRequest read_upload_request(Exchange& exchange, JobService& service);

}  // namespace sheetform::server
