#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

// The lines of the histograms that cyclictest and rtla print.
namespace hvp::files {

// The words of a line.
std::vector<std::string_view> cells(std::string_view line);

// A whole number from 0 to 10^12, if the word is one.
std::optional<std::int64_t> whole_count(std::string_view cell);
// The same; throws InputError with the line's number otherwise.
std::int64_t count_of(std::string_view cell, std::size_t line);

// A latency in s of a number in units of 10^exponent s. Throws InputError with the line's number
// where it is none from 0 to 1 s.
double latency_of(std::string_view cell, int exponent, std::size_t line);

// The next line of the text, which loses it.
std::string_view next_line(std::string_view& text);
bool is_empty_line(std::string_view line);

}  // namespace hvp::files
