#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vp/frame/frame.h"

namespace hvp::results {

// How numbers stand in every result file and on the terminal.

// Picoseconds as microseconds with all six decimals: exact, "1.250000".
std::string microseconds(vp::Picoseconds time);

// The shortest text that reads back as the same double; "nan" never occurs.
std::string shortest(double value);

// For people: a time with three significant digits and its unit, "1.25 ms", "650 us".
std::string readable_time(vp::Picoseconds time);

// For people: "1 frame", "2 frames".
std::string counted(std::int64_t count, std::string_view what);

// For people: "4.2 %", "0.038 %".
std::string percent(double ratio);

// For people: three significant digits and the unit, "1.42 N", "98.1 mN", "52.0 mm".
std::string newtons(double force);
std::string readable_length(double metres);

}  // namespace hvp::results
