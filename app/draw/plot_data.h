#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The computations for a two-dimensional plot: ticks, units, decimated lines, bins.

namespace hvp::draw {

struct Ticks {
  double step = 1.0;
  std::vector<double> values;       // multiples of step within [low, high], ascending
  std::vector<std::string> labels;  // all with as many decimals as the step needs
};

// About `wanted` round ticks (1, 2 or 5 times a power of ten apart) within [low, high];
// low < high, both finite, wanted ≥ 1.
Ticks round_ticks(double low, double high, int wanted);

// Whole-number ticks for a count (frames): as above with a step of at least one.
Ticks whole_ticks(double low, double high, int wanted);

// At most four significant digits, without an exponent where that is readable and without
// trailing zeros: "0.0123", "842.4", "1.2", "12345".
std::string four_digits(double value);

// A unit to write values in: "mm" is 1e-3 of "m".
struct Unit {
  double size = 1.0;
  std::string name;
};

// The unit for values up to `largest` of the unit `symbol`. It is the preferred one, a power of
// 1000 such as 1e-3, where `largest` is zero or 0.01 to 10 000 of it; else one in which it is 1 to
// 1000.
Unit unit_for(double largest, std::string_view symbol, double preferred);

// Decimates a line through many samples: in each of `columns` equal parts of [from, to] it keeps
// the first, the least, the largest and the last sample, in their order, so that an oscillation
// within a column keeps its height (M4: Jugel, Jerzak, Hackenbroich and Markl, Proc. VLDB Endowment
// 7, 2014). A value that is not finite ends a stroke. `x` ascends and has the size of `y`; from <
// to.
std::vector<std::vector<Eigen::Vector2d>> strokes(std::span<const double> x,
                                                  std::span<const double> y, double from, double to,
                                                  int columns);

// A stretch of the x axis.
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

// The stretches in which y < level: from each such sample to the one after it. Two stretches that
// are less than `gap` apart are joined.
std::vector<Stretch> stretches_below(std::span<const double> x, std::span<const double> y,
                                     double level, double gap);

// A histogram of latencies, in bins of one width. Microseconds.
struct LatencyBins {
  // `frames` is the number of latencies in (from, to].
  struct Bin {
    double from = 0.0;
    double to = 0.0;
    std::size_t frames = 0;
    std::size_t missed = 0;  // of those, the late ones and those without a solution
    bool late = false;       // beyond the budget
  };

  double width = 0.0;     // 1, 2 or 5 times a power of ten
  std::vector<Bin> bins;  // ascending, without the empty ones
  double p50 = 0.0;       // the least latency that 50 % of the frames do not exceed
  double p99 = 0.0;
  std::size_t fullest = 0;  // the most frames in a bin
};

// Counts latencies in about `wanted` bins, at most twice as many, which cover all latencies and the
// budget. The budget is an edge between two bins, so that no bin is partly late. `latencies` are
// finite, in any order; `missed` are those of them that count as missed though they are not late.
// Without latencies there are no bins and the figures are 0.
LatencyBins latency_bins(std::vector<double> latencies, double budget_us, int wanted,
                         const std::vector<double>& missed = {});

}  // namespace hvp::draw
