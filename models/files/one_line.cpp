#include "models/files/one_line.h"

#include <array>
#include <cstdint>

#include <fmt/format.h>

namespace hvp::files {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: no UTF-8
};

// The first character of a text that is not empty (RFC 3629).
Character first_character(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return std::uint32_t{static_cast<unsigned char>(text[i])};
  };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80U) return {lead, 1};
  const std::size_t bytes = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  if (lead < 0xC2U || lead > 0xF4U || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = code << 6U | (byte(i) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  if (code < kLeast[bytes] || code > 0x10FFFFU || surrogate) return {};
  return {code, bytes};
}

// C0, DEL and C1, line and paragraph separators, and the characters of the bidirectional algorithm
// that reorder what stands beside them (UAX #9).
bool obeyed(std::uint32_t code) {
  return code < 0x20U || (code >= 0x7FU && code <= 0x9FU) || code == 0x2028U || code == 0x2029U ||
         (code >= 0x202AU && code <= 0x202EU) || (code >= 0x2066U && code <= 0x2069U);
}

std::string escaped(std::string_view text, bool keep_line_ends) {
  std::string result;
  while (!text.empty()) {
    const Character c = first_character(text);
    if (c.bytes == 0) {
      result +=
          fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(text[0])));
    } else if (!obeyed(c.code) || (c.code == '\n' && keep_line_ends)) {
      result += text.substr(0, c.bytes);
    } else if (c.code == '\n') {
      result += "\\n";
    } else if (c.code == '\r') {
      result += "\\r";
    } else if (c.code == '\t') {
      result += "\\t";
    } else {
      result += fmt::format("\\u{:04x}", c.code);
    }
    text.remove_prefix(c.bytes == 0 ? 1 : c.bytes);
  }
  return result;
}

}  // namespace

std::string one_line(std::string_view text, std::size_t limit) {
  std::size_t end = text.size();
  if (end > limit) {
    end = limit;
    // 10xxxxxx continues a character of several bytes.
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  }
  return escaped(text.substr(0, end), false) + (end < text.size() ? "..." : "");
}

std::string printable(std::string_view text) { return escaped(text, true); }

std::string in_quotes(std::string_view text, std::size_t limit) {
  return '"' + one_line(text, limit) + '"';
}

}  // namespace hvp::files
