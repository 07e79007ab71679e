#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "models/fixed/settings.h"
#include "tests/vp/stimulus.h"
#include "vp/frame/frame.h"

// What the default configuration takes, counted out instead of computed by the models' closed
// forms: PCI 32/33 clock by clock, the accelerator at 100 MHz package by package.
namespace hvp::test {

inline constexpr vp::Picoseconds kPciClock = 30 * kNs;
inline constexpr vp::Picoseconds kBoardClock = 10 * kNs;

inline vp::Picoseconds pci(int bytes, int overhead_clocks, vp::Picoseconds latency) {
  std::int64_t clocks = 0;
  for (int done = 0; done < bytes;) {
    clocks += overhead_clocks;
    for (int in_burst = 0; in_burst < 64 && done < bytes; in_burst += 4, done += 4) ++clocks;
  }
  return latency + clocks * kPciClock;
}
inline vp::Picoseconds pci_write(int bytes) { return pci(bytes, 4, 100 * kNs); }
inline vp::Picoseconds pci_read(int bytes) { return pci(bytes, 4 + 8, 700 * kNs); }

// Packages of eight columns that a block row fills.
inline int packages(int blocks) {
  int n = 0;
  for (int columns = 3 * blocks; columns > 0; columns -= 8) ++n;
  return n;
}

// Longest rows first, each to the partition that has least.
inline std::int64_t fullest_of_five(std::vector<int> blocks_in_row) {
  std::sort(blocks_in_row.begin(), blocks_in_row.end(), std::greater<>());
  std::vector<std::int64_t> partition(5, 0);
  for (const int blocks : blocks_in_row) {
    *std::min_element(partition.begin(), partition.end()) += packages(blocks);
  }
  return *std::max_element(partition.begin(), partition.end());
}

inline std::vector<int> blocks_in_rows(const std::vector<int>& row_begin) {
  std::vector<int> blocks;
  for (std::size_t i = 1; i < row_begin.size(); ++i) {
    blocks.push_back(row_begin[i] - row_begin[i - 1]);
  }
  return blocks;
}

// What a job made.
struct Made {
  fixed::Method method = fixed::Method::cg;
  int passes = 60;
  int replacements = 0;  // in the first passes
  bool extrapolated = false;
  bool dynamic_scaling = true;
  bool broken_down = false;
  int scalar_bits = 64;
  int coefficient_bits = 16;
  int scaling_step = 1;
};

// Clocks that a product's last rows wait for each other: of the small scene's 48 rows the
// partitions finish the last ones together, and two are taken at a time.
inline constexpr std::int64_t kRowsTogether = 1;

// Pipelines of 20 clocks, two nodes a clock and divisions of 68 clocks and more, step by step: a
// step begins when all that it needs has ended (docs/accelerator.md).
class SolveClocks {
 public:
  explicit SolveClocks(const std::vector<int>& row_begin) {
    const std::vector<int> blocks = blocks_in_rows(row_begin);
    const auto nodes = static_cast<std::int64_t>(blocks.size());
    product_ = fullest_of_five(blocks) + 20 + kRowsTogether;
    vectors_ = nodes / 2 + nodes % 2 + 20;
  }

  std::int64_t operator()(const Made& made) const {
    const std::int64_t begin = made.extrapolated ? vectors_ : 0;
    // r = b − A·x, and the first d.
    const std::int64_t ready = begin + product_ + vectors_ + vectors_;
    switch (made.method) {
      case fixed::Method::chronopoulos_gear:
        return chronopoulos_gear(made, ready);
      case fixed::Method::pipelined_cg:
        return pipelined(made, ready);
      default:
        return conjugate_gradients(made, ready);
    }
  }

 private:
  // A bit of the mantissa more is a clock of the divider and one of the re-scaling behind it; wider
  // scalars have eight bytes more to be moved by, and another step is divided by.
  static std::int64_t division(const Made& made) {
    return 68 + 2 * (made.coefficient_bits - 16) + (made.scalar_bits == 128 ? 8 : 0) +
           (made.scaling_step == 1 ? 0 : 14);
  }
  // β·(dᵀAd), twice: 63 or 127 bits, 17 a clock.
  static std::int64_t curvature(const Made& made) {
    return made.scalar_bits == 128 ? 8 + 8 : 4 + 4;
  }

  // Thesis Fig. 4.4.
  std::int64_t conjugate_gradients(const Made& made, std::int64_t now) const {
    for (int pass = 0; pass < made.passes; ++pass) {
      now += product_;
      now += division(made);
      now += vectors_;
      if (pass < made.replacements) now += product_ + vectors_;
      now += division(made);
      now += vectors_;
    }
    return made.broken_down ? now + product_ : now;
  }

  std::int64_t chronopoulos_gear(const Made& made, std::int64_t ready) const {
    std::int64_t alpha = ready + product_ + product_ + division(made);  // A·r, A·d
    std::int64_t direction = alpha;
    for (int pass = 0; pass < made.passes; ++pass) {
      std::int64_t residual = std::max(alpha, direction) + vectors_;
      if (pass < made.replacements) residual += product_ + vectors_;
      const std::int64_t beta =
          std::max(residual + product_, residual + division(made) + curvature(made));
      alpha = beta + division(made);
      // In one pass with the next x and r where no size has to be awaited.
      direction = made.dynamic_scaling ? beta + vectors_ : 0;
    }
    return std::max(alpha, direction);
  }

  std::int64_t pipelined(const Made& made, std::int64_t ready) const {
    const std::int64_t scaled = made.dynamic_scaling ? vectors_ : 0;
    // A·r and A·d in vector words, A·A·r and A·A·d.
    std::int64_t now = ready + product_ + scaled + product_ + scaled + product_ + product_;
    for (int pass = 0; pass < made.passes; ++pass) {
      now += vectors_;
      if (pass < made.replacements) {
        now += product_ + vectors_;
        now += product_ + scaled + product_ + scaled + product_;
      }
      now = std::max(now + product_, now + division(made) + curvature(made) + division(made));
      if (made.dynamic_scaling) now += vectors_;
    }
    return now;
  }

  std::int64_t product_;
  std::int64_t vectors_;
};

inline vp::Picoseconds solve_time(const std::vector<int>& row_begin, const Made& made) {
  return SolveClocks(row_begin)(made) * kBoardClock;
}
inline vp::Picoseconds solve_time(const std::vector<int>& row_begin, int iterations) {
  return solve_time(row_begin, Made{.passes = iterations});
}

// Host computation at 297.88 Mflop/s.
inline vp::Picoseconds compute(double operations) {
  return std::llround(operations / 297.88e6 * 1e12);
}

}  // namespace hvp::test
