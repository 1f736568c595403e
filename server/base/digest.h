// SHA-256, base64, and comparison that takes the same time whatever differs.
#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace sheetform::server {

/// SHA-256 of what is added piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void add(std::string_view bytes);
  /// The 32 bytes; call once.
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string sha256(std::string_view bytes);

std::string to_base64(std::string_view bytes);
/// False when the text is not canonical base64 with padding. Line breaks are not taken.
bool from_base64(std::string_view text, std::string& bytes);

/// Equal in content; the time does not depend on where they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace sheetform::server
