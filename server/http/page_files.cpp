#include "server/http/page_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <utility>

#include "server/base/digest.h"
#include "server/base/identity.h"
#include "server/http/conditional.h"

namespace sheetform::server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPacked = ".gz";
constexpr std::uint64_t kFolderBytes = std::uint64_t{64} << 20;
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
    "'self'; "
    "font-src 'self'; worker-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

constexpr std::array<std::pair<std::string_view, const char*>, 14> kTypes{
    {{".html", "text/html; charset=utf-8"},
     {".js", "text/javascript; charset=utf-8"},
     {".mjs", "text/javascript; charset=utf-8"},
     {".css", "text/css; charset=utf-8"},
     {".json", "application/json"},
     {".map", "application/json"},
     {".svg", "image/svg+xml"},
     {".png", "image/png"},
     {".jpg", "image/jpeg"},
     {".ico", "image/x-icon"},
     {".woff2", "font/woff2"},
     {".wasm", "application/wasm"},
     {".obj", "model/obj"},
     {".txt", "text/plain; charset=utf-8"}}};

std::string type_of(const std::string& path) {
  for (const auto& [ending, type] : kTypes)
    if (path.size() > ending.size() && path.compare(path.size() - ending.size(), ending.size(), ending) == 0)
      return type;
  return "application/octet-stream";
}

/// A name with esbuild's hash in it ("main-1A2B3C4D.js") never changes its content.
bool has_hash(const std::string& path) {
  const std::size_t dot = path.rfind('.'), dash = path.find_last_of("-.", dot == 0 ? 0 : dot - 1);
  if (dot == std::string::npos || dash == std::string::npos || dot - dash != 9) return false;
  return std::all_of(path.begin() + static_cast<std::ptrdiff_t>(dash) + 1,
                     path.begin() + static_cast<std::ptrdiff_t>(dot),
                     [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
}

/// Whether gzip is in Accept-Encoding and not refused by q=0.
bool takes_gzip(const RequestHead& head) {
  const std::string field = head.field("accept-encoding");
  const std::size_t at = field.find("gzip");
  if (at == std::string::npos) return false;
  const std::string rest = field.substr(at + 4, field.find(',', at) - at - 4);
  return rest.find("q=0") == std::string::npos || rest.find("q=0.") != std::string::npos;
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error("the page's file " + path.string() + " cannot be read");
  return text.str();
}

void add_security(Answer& answer) {
  answer.with("Content-Security-Policy", kPolicy)
      .with("Cross-Origin-Opener-Policy", "same-origin")
      .with("Cross-Origin-Resource-Policy", "same-origin")
      .with("Referrer-Policy", "no-referrer");
}

}  // namespace

PageFiles::PageFiles(const fs::path& folder) {
  if (!folder.empty()) {
    add_folder(folder);
    return;
  }
  for (const BuiltInFile* f = kBuiltInFiles; f->path != nullptr; ++f)
    add(f->path, std::string(f->begin, static_cast<std::size_t>(f->end - f->begin)));
}

void PageFiles::add(const std::string& path, std::string content) {
  File& file = files_["/" + path];
  file.content = std::move(content);
  file.tag = "\"" + to_hex(sha256(file.content)).substr(0, 32) + "\"";
}

void PageFiles::add_folder(const fs::path& folder) {
  std::uint64_t total = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.is_symlink()) continue;
    total += entry.file_size();
    if (total > kFolderBytes)
      throw std::runtime_error("the page's folder " + folder.string() + " is too large");
    add(fs::relative(entry.path(), folder).generic_string(), read_file(entry.path()));
  }
}

std::optional<Answer> PageFiles::find(const RequestHead& head) const {
  const std::string path = head.path == "/" ? "/index.html" : head.path;
  const auto plain = files_.find(path), packed = files_.find(path + kPacked);
  if (plain == files_.end()) return std::nullopt;
  const bool pack = packed != files_.end() && takes_gzip(head);
  const File& file = pack ? packed->second : plain->second;
  const bool same = head.has("if-none-match") && names_tag(head.field("if-none-match"), file.tag, true);
  Answer answer = same ? Answer{} : text_answer(200, type_of(path), file.content);
  if (same) answer.status = 304;
  if (packed != files_.end()) answer.with("Vary", "Accept-Encoding");
  if (pack) answer.with("Content-Encoding", "gzip");
  answer.with("ETag", file.tag)
      .with("Cache-Control", has_hash(path) ? "public, max-age=31536000, immutable" : "no-cache");
  add_security(answer);
  return answer;
}

}  // namespace sheetform::server
