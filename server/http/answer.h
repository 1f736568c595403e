// What a handler answers with: plain data, turned into bytes by guard_server alone.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sheetform_api/problem.h"

namespace sheetform::server {

/// Content of known length that is read piece by piece. read(offset, most) answers at least one byte below
/// `length`; an exception or an empty answer breaks the connection.
struct PiecewiseContent {
  std::uint64_t length = 0;
  std::function<std::string(std::uint64_t offset, std::uint64_t most)> read;
};

/// Content that comes over time. step is called again and again; it waits a while at most and answers false
/// at the end. write answers false when the peer is gone.
struct LiveContent {
  using Write = std::function<bool(std::string_view)>;
  std::function<bool(const Write&)> step;
};

struct Answer {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string media_type;
  std::string body;
  std::shared_ptr<PiecewiseContent> pieces;
  std::shared_ptr<LiveContent> live;

  /// Adds a header; control characters become spaces.
  Answer& with(const std::string& name, const std::string& value);
  bool has(std::string_view name) const;
};

Answer json_answer(int status, const api::Json& value);
Answer json_answer(int status, const api::OrderedJson& value);
Answer text_answer(int status, const std::string& media_type, std::string body);
/// With the headers that belong to the type (WWW-Authenticate, Retry-After, ...), and with what usually helps
/// when the problem does not say it.
Answer problem_answer(api::Problem problem);

}  // namespace sheetform::server
