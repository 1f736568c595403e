// Numbers and texts as the writers of files need them: independent of locale, the same bytes everywhere.
#pragma once
#include <string>
#include <string_view>

namespace sheetform {

/// Shortest decimal that reads back as the same double (up to 17 significant digits). -0 is written as 0.
/// Not finite: Error kInternal, as no file of ours may hold it.
void append_exact(std::string& out, double value);
/// At most `decimals` digits after the point, trailing zeros dropped, never an exponent, never "-0".
void append_rounded(std::string& out, double value, int decimals);
std::string exact(double value);
std::string rounded(double value, int decimals);

/// Text for XML content and attributes: & < > " ' escaped, characters that XML 1.0 does not allow and broken
/// UTF-8 replaced by U+FFFD.
std::string xml_escaped(std::string_view text);
/// `text` as valid UTF-8: broken sequences replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

}  // namespace sheetform
