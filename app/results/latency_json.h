#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/results/latency_figures.h"

namespace hvp::results {

// `latency` of summary.json.
nlohmann::ordered_json latency_json(const LatencyFigures& figures);

// {p50_us, p99_us, worst_us, mean_us}
nlohmann::ordered_json spread_json(const Spread& spread);

// How many times were at least `from_us` and less than twice that; `counted` names the number.
nlohmann::ordered_json octaves_json(const std::vector<statistics::Histogram::Octave>& octaves,
                                    const char* counted);

// The double next to the exact value, which prints without a tail: 651.34.
inline double us(vp::Picoseconds time) { return static_cast<double>(time) / 1e6; }

}  // namespace hvp::results
