#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "models/files/one_line.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"

// What the readers of polygon_files.h share: the words of a text with the numbers of their lines,
// and coordinates as single precision has them.
namespace hvp::mesh {

inline constexpr std::string_view kBlanks = " \t\r\v\f";

inline std::string shown(std::string_view text) { return files::one_line(text, 40); }

inline void check_face_count(std::uint64_t count, std::string_view what) {
  if (count <= kMostTriangles) return;
  refuse(fmt::format("the file has {} {}; at most {} are read", count, what, kMostTriangles));
}

inline std::string_view without_byte_order_mark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  return bytes;
}

// A text without what editors and programs put around it.
inline std::string_view text_of(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  while (!bytes.empty() && bytes.back() == '\0') bytes.remove_suffix(1);
  return bytes;
}

// The words of a text, one after the other, with the number of their line.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  // The next word of the present line; empty at its end.
  std::string_view in_line() {
    const std::size_t begin = std::min(rest_.find_first_not_of(kBlanks), rest_.size());
    rest_.remove_prefix(begin);
    const std::size_t end = std::min(rest_.find_first_of(" \t\r\v\f\n"), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return word;
  }
  // Goes to the next line; false at the end of the text.
  bool next_line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) {
      rest_ = {};
      return false;
    }
    rest_.remove_prefix(end + 1);
    ++line_;
    return !rest_.empty();
  }
  // The next word on this line or a later one; empty at the end of the text.
  std::string_view anywhere() {
    std::string_view word = in_line();
    while (word.empty() && next_line()) word = in_line();
    return word;
  }
  std::size_t line() const { return line_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 1;
};

[[noreturn]] inline void refuse_line(std::size_t line, const std::string& what) {
  refuse(fmt::format("line {}: {}", line, what));
}

// The number as single precision has it; infinite beyond that.
inline double single(double value) { return static_cast<double>(static_cast<float>(value)); }

inline double coordinate(std::string_view word, std::size_t line) {
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool small = error == std::errc::result_out_of_range && std::abs(value) < 1;
  if ((error != std::errc{} && !small) || end != digits.data() + digits.size() ||
      !std::isfinite(value)) {
    refuse_line(line, fmt::format("the coordinate \"{}\" is not a finite number", shown(word)));
  }
  return single(value);
}

template <class Number>
std::optional<Number> whole(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

inline bool is_word(std::string_view text, std::string_view small_letters) {
  return std::ranges::equal(text, small_letters, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

}  // namespace hvp::mesh
