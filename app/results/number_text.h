#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vp/frame/frame.h"

namespace hvp::fixed {
struct SystemSpectrum;
}

// Numbers as text in result files and on the terminal.

namespace hvp::results {

// Picoseconds as microseconds with all six decimals: exact, "1.250000".
std::string microseconds(vp::Picoseconds time);

// The shortest text that reads back as the same double; the value is never a NaN.
std::string shortest(double value);

// The functions below round for a reader on the terminal.

// A time in ms, us or ns: "1.250 ms", "650.0 us", "15 ns".
std::string readable_time(vp::Picoseconds time);

// "1 frame", "2 frames".
std::string counted(std::int64_t count, std::string_view what);

// Ratios and forces (N) beyond it are no figures of a body that still moves as one: what is printed
// says that they are beyond, and result files have null. Percentiles end there (host::Deviation).
inline constexpr double kMeasurable = 1e6;

// "42 %", "4.2 %", "0.038 %"; "beyond 1e+08 %" or "not measurable".
std::string percent(double ratio);

// Three significant digits and the unit: "1.42 N", "98.1 mN", "52.0 mm", "10.0 kPa".
std::string newtons(double force);
std::string readable_length(double metres);
std::string readable_stress(double pascal);

// A line for each matrix whose spectrum was bounded: κ, the smallest and the largest eigenvalue.
std::string spectrum_text(const fixed::SystemSpectrum& spectrum);

}  // namespace hvp::results
