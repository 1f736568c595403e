// Random names: job ids, request ids, tokens, and the secret parts of them. All from the kernel's generator.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace sheetform::server {

/// `count` random bytes. Throws std::system_error when the kernel has none.
std::string random_bytes(std::size_t count);
/// UUID version 7: begins with the time, so that ids sort like jobs.
std::string make_uuid();
/// Whether the text has the form of a UUID (lower-case hexadecimal).
bool is_uuid(std::string_view text);

std::string to_hex(std::string_view bytes);
/// False when the text is no even number of hexadecimal digits.
bool from_hex(std::string_view text, std::string& bytes);

}  // namespace sheetform::server
