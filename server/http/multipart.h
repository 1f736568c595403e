// multipart/form-data (RFC 7578), read as it comes: files go to their place piece by piece, fields stay
// small.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "sheetform_api/problem.h"

namespace sheetform::server {

/// The boundary of a Content-Type field; empty when it has none or a wrong one.
std::string multipart_boundary(const std::string& content_type);

struct PartHead {
  std::string name, filename, content_type;
  bool is_file = false;  ///< has a filename
};

/// Takes the body in pieces of any size. Memory stays below two pieces plus 8 KiB.
class MultipartReader {
 public:
  struct Callbacks {
    std::function<void(const PartHead&)> begin;
    std::function<void(std::string_view)> data;
    std::function<void()> end;
  };
  MultipartReader(const std::string& boundary, Callbacks callbacks);

  /// False when the body is broken; `error` says how.
  bool add(std::string_view piece);
  /// After the last piece: whether the closing boundary was there.
  bool complete();
  const std::string& error() const { return error_; }

 private:
  enum class State { kPreamble, kAfterBoundary, kHead, kData, kEpilogue, kBroken };
  bool step();
  bool step_preamble();
  bool step_after_boundary();
  bool step_head();
  bool step_data();
  bool broken(const std::string& why);
  bool parse_head(std::string_view text);

  std::string delimiter_;  ///< CR LF -- boundary
  Callbacks callbacks_;
  State state_ = State::kPreamble;
  std::string buffer_;
  std::string error_;
  int parts_ = 0;
};

/// Name of an uploaded file for display: the last part of a path, without controls and signs that turn text
/// around, at most 128 bytes of valid UTF-8.
std::string display_name(std::string_view filename);

}  // namespace sheetform::server
