#include "server/http/multipart.h"

#include <algorithm>
#include <cctype>

#include "server/http/field_text.h"

namespace sheetform::server {
namespace {

constexpr std::size_t kBoundaryBytes = 70;
constexpr std::size_t kPartHeadBytes = 4096;
constexpr int kParts = 32;
constexpr std::size_t kNameBytes = 128;

bool is_boundary_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("'()+_,-./:=? ").find(c) != std::string_view::npos;
}

/// Value of a quoted or bare parameter at the front of `text`, which is moved past it.
bool take_value(std::string_view& text, std::string& value) {
  value.clear();
  if (text.empty() || text.front() != '"') {
    const std::size_t end = std::min(text.find(';'), text.size());
    value = trimmed(text.substr(0, end));
    text.remove_prefix(end);
    return !value.empty();
  }
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '"') {
      text.remove_prefix(i + 1);
      return true;
    }
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\')) ++i;
    value += text[i];
  }
  return false;
}

/// Calls use(name, value) for each "; name=value" of a field after its first word. False when it is
/// malformed.
template <class Use>
bool for_each_parameter(std::string_view field, Use&& use) {
  std::size_t semicolon = field.find(';');
  if (semicolon == std::string_view::npos) return true;
  std::string_view rest = field.substr(semicolon);
  while (!rest.empty()) {
    rest = trimmed(rest);
    if (rest.empty()) return true;
    if (rest.front() != ';') return false;
    rest = trimmed(rest.substr(1));
    if (rest.empty()) return true;
    const std::size_t equals = rest.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string name = lower(trimmed(rest.substr(0, equals)));
    rest = trimmed(rest.substr(equals + 1));
    std::string value;
    if (!take_value(rest, value)) return false;
    use(name, value);
  }
  return true;
}

/// Length of the UTF-8 sequence at the front, 0 when it is broken.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char c = byte(0);
  const std::size_t length = c < 0x80                ? 1
                             : c >= 0xc2 && c < 0xe0 ? 2
                             : c >= 0xe0 && c < 0xf0 ? 3
                             : c >= 0xf0 && c < 0xf5 ? 4
                                                     : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  if (c == 0xe0 && byte(1) < 0xa0) return 0;
  if (c == 0xed && byte(1) >= 0xa0) return 0;  // surrogates
  if (c == 0xf0 && byte(1) < 0x90) return 0;
  if (c == 0xf4 && byte(1) >= 0x90) return 0;
  return length;
}

/// Marks that change the direction of text, and separators that no name needs.
bool is_unwanted(std::string_view character) {
  if (character.size() == 1) {
    const auto c = static_cast<unsigned char>(character[0]);
    return c < 0x20 || c == 0x7f || c == ':';
  }
  if (character.size() == 2)
    return static_cast<unsigned char>(character[0]) == 0xc2 &&
           static_cast<unsigned char>(character[1]) < 0xa0;
  if (character.substr(0, 2) == "\xe2\x80") {
    const auto c = static_cast<unsigned char>(character[2]);
    return (c >= 0x8b && c <= 0x8f) || (c >= 0xa8 && c <= 0xae);
  }
  if (character.substr(0, 2) == "\xe2\x81") {
    const auto c = static_cast<unsigned char>(character[2]);
    return c >= 0xa6 && c <= 0xa9;
  }
  return character == "\xef\xbb\xbf";
}

}  // namespace

std::string multipart_boundary(const std::string& content_type) {
  if (lower(trimmed(std::string_view(content_type).substr(0, content_type.find(';')))) !=
      "multipart/form-data")
    return {};
  std::string boundary;
  int count = 0;
  const bool good = for_each_parameter(content_type, [&](const std::string& name, const std::string& value) {
    if (name == "boundary") boundary = value, ++count;
  });
  if (!good || count != 1 || boundary.empty() || boundary.size() > kBoundaryBytes || boundary.back() == ' ')
    return {};
  return std::all_of(boundary.begin(), boundary.end(), is_boundary_char) ? boundary : std::string();
}

MultipartReader::MultipartReader(const std::string& boundary, Callbacks callbacks)
    : delimiter_("\r\n--" + boundary),
      callbacks_(std::move(callbacks)),
      buffer_("\r\n") {}  // the first one needs no CR LF

bool MultipartReader::broken(const std::string& why) {
  if (error_.empty()) error_ = why;
  state_ = State::kBroken;
  return false;
}

bool MultipartReader::add(std::string_view piece) {
  if (state_ == State::kBroken) return false;
  if (state_ == State::kEpilogue) return true;  // what follows the last boundary is not ours
  buffer_.append(piece);
  while (step()) continue;
  return state_ != State::kBroken;
}

bool MultipartReader::complete() {
  if (state_ == State::kEpilogue) return true;
  broken("the body ends before its closing boundary");
  return false;
}

/// Does one thing with the buffer; false when it needs more bytes, or none.
bool MultipartReader::step() {
  switch (state_) {
    case State::kPreamble:
      return step_preamble();
    case State::kAfterBoundary:
      return step_after_boundary();
    case State::kHead:
      return step_head();
    case State::kData:
      return step_data();
    case State::kEpilogue:
    case State::kBroken:
      return false;
  }
  return false;
}

bool MultipartReader::step_preamble() {
  const std::size_t at = buffer_.find(delimiter_);
  if (at == std::string::npos) {
    if (buffer_.size() > kPartHeadBytes + delimiter_.size())
      return broken("the body does not begin with its boundary");
    return false;
  }
  buffer_.erase(0, at + delimiter_.size());
  state_ = State::kAfterBoundary;
  return true;
}

bool MultipartReader::step_after_boundary() {
  if (buffer_.size() < 2) return false;
  if (buffer_.compare(0, 2, "--") == 0) {
    buffer_.clear();
    state_ = State::kEpilogue;
    return false;
  }
  // Blanks may stand between boundary and end of line (RFC 2046); nothing else.
  const std::size_t text = buffer_.find_first_not_of(" \t");
  if (text == std::string::npos || text + 1 >= buffer_.size())
    return buffer_.size() > kPartHeadBytes ? broken("a boundary is followed by something else") : false;
  if (buffer_.compare(text, 2, "\r\n") != 0) return broken("a boundary is followed by something else");
  buffer_.erase(0, text);  // the CR LF stays: a head may be empty
  state_ = State::kHead;
  return true;
}

bool MultipartReader::step_head() {
  const std::size_t end = buffer_.find("\r\n\r\n");
  if (end == std::string::npos || end > kPartHeadBytes)
    return buffer_.size() > kPartHeadBytes ? broken("the head of a part is larger than 4096 bytes") : false;
  if (++parts_ > kParts) return broken("there are more than 32 parts");
  const std::string head = buffer_.substr(2, end);  // each line with its CR LF
  buffer_.erase(0, end + 4);
  state_ = State::kData;
  return parse_head(head) || broken("the head of a part is malformed");
}

bool MultipartReader::step_data() {
  const std::size_t at = buffer_.find(delimiter_);
  if (at != std::string::npos) {
    if (at > 0) callbacks_.data(std::string_view(buffer_).substr(0, at));
    callbacks_.end();
    buffer_.erase(0, at + delimiter_.size());
    state_ = State::kAfterBoundary;
    return true;
  }
  // Whatever cannot be the beginning of a delimiter any more is data.
  if (buffer_.size() < delimiter_.size()) return false;
  const std::size_t sure = buffer_.size() - delimiter_.size() + 1;
  callbacks_.data(std::string_view(buffer_).substr(0, sure));
  buffer_.erase(0, sure);
  return false;
}

bool MultipartReader::parse_head(std::string_view text) {
  PartHead head;
  bool disposed = false, good = true;
  while (!text.empty()) {
    const std::size_t end = text.find("\r\n");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 2);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || line.find('\0') != std::string_view::npos) return false;
    const std::string name = lower(trimmed(line.substr(0, colon)));
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (name == "content-type") head.content_type = value;
    if (name == "content-transfer-encoding" && lower(value) != "binary" && lower(value) != "8bit" &&
        lower(value) != "7bit")
      return false;
    if (name != "content-disposition") continue;
    if (disposed || lower(trimmed(value.substr(0, value.find(';')))) != "form-data") return false;
    disposed = true;
    good = for_each_parameter(value, [&](const std::string& key, const std::string& text_value) {
      if (key == "name") head.name = text_value;
      if (key == "filename") head.filename = text_value, head.is_file = true;
    });
  }
  if (!disposed || !good || head.name.empty()) return false;
  callbacks_.begin(head);
  return true;
}

std::string display_name(std::string_view filename) {
  filename = filename.substr(filename.find_last_of("/\\") + 1);
  std::string name;
  while (!filename.empty()) {
    const std::size_t length = utf8_length(filename);
    const std::string_view character = filename.substr(0, std::max<std::size_t>(length, 1));
    filename.remove_prefix(character.size());
    if (name.size() + character.size() > kNameBytes) break;
    if (length > 0 && !is_unwanted(character)) name += character;
  }
  const std::size_t first = name.find_first_not_of(". ");
  return first == std::string::npos ? std::string() : name.substr(first);
}

}  // namespace sheetform::server
