#include "app/scenario/message.h"

#include <fmt/format.h>

namespace hvp::scenario {
namespace {

bool is_bare(std::string_view key) {
  for (const char c : key) {
    const bool bare = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '_' || c == '-';
    if (!bare) return false;
  }
  return !key.empty();
}

}  // namespace

std::string key_text(std::string_view key) {
  return is_bare(key) ? one_line(key, 60) : in_quotes(key);
}

std::string joined(std::string_view table, std::string_view key) {
  if (table.empty()) return std::string(key);
  if (key.empty()) return std::string(table);
  return fmt::format("{}.{}", table, key);
}

}  // namespace hvp::scenario
