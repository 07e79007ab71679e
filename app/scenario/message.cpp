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

std::string one_line(std::string_view text, std::size_t limit) {
  std::string result;
  std::size_t end = text.size();
  if (end > limit) {
    end = limit;
    // 10xxxxxx continues a character of several bytes.
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  }
  for (std::size_t i = 0; i < end; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\n') {
      result += "\\n";
    } else if (c == '\r') {
      result += "\\r";
    } else if (c == '\t') {
      result += "\\t";
    } else if (c < 0x20U || c == 0x7FU) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      result += text[i];
    }
  }
  if (end < text.size()) result += "...";
  return result;
}

std::string in_quotes(std::string_view text, std::size_t limit) {
  return '"' + one_line(text, limit) + '"';
}

std::string key_text(std::string_view key) {
  return is_bare(key) ? one_line(key, 60) : in_quotes(key);
}

std::string joined(std::string_view table, std::string_view key) {
  if (table.empty()) return std::string(key);
  if (key.empty()) return std::string(table);
  return fmt::format("{}.{}", table, key);
}

std::string alternatives(const std::vector<std::string>& items) {
  std::string result;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) result += i + 1 == items.size() ? " or " : ", ";
    result += items[i];
  }
  return result;
}

}  // namespace hvp::scenario
