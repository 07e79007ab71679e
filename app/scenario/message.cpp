#include "app/scenario/message.h"

#include <algorithm>
#include <string>

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

namespace {

std::string folded(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-') c = '_';
  }
  return result;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::string s = folded(a);
  const std::string t = folded(b);
  std::vector<std::size_t> before(t.size() + 1);
  std::vector<std::size_t> above(t.size() + 1);
  std::vector<std::size_t> row(t.size() + 1);
  for (std::size_t j = 0; j <= t.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= s.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= t.size(); ++j) {
      const std::size_t substitution = above[j - 1] + (s[i - 1] == t[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && s[i - 1] == t[j - 2] && s[i - 2] == t[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(above);
    above.swap(row);
  }
  return above[t.size()];
}

std::string_view nearest(std::string_view name, const std::vector<std::string_view>& candidates) {
  std::string_view best;
  std::size_t best_distance = 0;
  for (const std::string_view candidate : candidates) {
    const std::size_t shorter = std::min(name.size(), candidate.size());
    const std::size_t longer = std::max(name.size(), candidate.size());
    const std::size_t limit = std::max<std::size_t>(1, shorter / 3);
    // The difference in length excludes most names at once, and it bounds the work for very long
    // ones.
    if (longer - shorter > limit) continue;
    const std::size_t distance = edit_distance(name, candidate);
    // A single letter is at distance one from every other letter.
    if (distance > limit || distance >= longer) continue;
    if (best.empty() || distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  if (!best.empty() || name.size() < 2) return best;
  for (const std::string_view candidate : candidates) {
    if (!folded(candidate.substr(0, name.size())).starts_with(folded(name))) continue;
    if (!best.empty()) return {};
    best = candidate;
  }
  return best;
}

}  // namespace hvp::scenario
