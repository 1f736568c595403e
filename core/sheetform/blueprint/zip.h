// Several files as one archive, the same bytes every time.
#pragma once
#include <string>
#include <vector>

namespace sheetform {

struct ZipEntry {
  std::string
      name;  ///< path inside; letters, digits, . - _ / only, so that it is harmless wherever it is unpacked
  std::string content;
};
/// Deflated; all times are 1980-01-01. Throws Error kInternal for names that break the rule, that repeat, or
/// for more than 4 GB.
std::string write_zip(const std::vector<ZipEntry>& entries);

/// A label or other text as part of a file name: what is not a letter, digit, - or _ becomes _. Never empty.
std::string file_name_of(const std::string& text);

/// zlib stream (RFC 1950), as PDF wants it.
std::string deflated(const std::string& content);

}  // namespace sheetform
