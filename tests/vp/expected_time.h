#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/vp/stimulus.h"
#include "vp/frame.h"

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

// Thesis Fig. 4.4 with pipelines of 20 clocks, two nodes a clock and divisions of 68 clocks.
inline vp::Picoseconds solve_time(const std::vector<int>& row_begin, int iterations) {
  const std::vector<int> blocks = blocks_in_rows(row_begin);
  const auto nodes = static_cast<std::int64_t>(blocks.size());
  const std::int64_t product = fullest_of_five(blocks) + 20;
  const std::int64_t vectors = nodes / 2 + nodes % 2 + 20;
  std::int64_t clocks = product + vectors + vectors;  // r and d of the initial guess
  for (int i = 0; i < iterations; ++i) clocks += product + 68 + vectors + 68 + vectors;
  return clocks * kBoardClock;
}

// Host computation at 297.88 Mflop/s.
inline vp::Picoseconds compute(double operations) {
  return std::llround(operations / 297.88e6 * 1e12);
}

}  // namespace hvp::test
