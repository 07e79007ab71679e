#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/scripted_board.h"

namespace hvp::test {

// A symmetric matrix over a chain of nodes: blocks (i, i−1), (i, i), (i, i+1), and entries that are
// all different, so that a misplaced one is seen.
struct ChainMatrix {
  explicit ChainMatrix(int nodes) {
    for (int i = 0; i < nodes; ++i) {
      for (int j = std::max(0, i - 1); j <= std::min(nodes - 1, i + 1); ++j) {
        column.push_back(j);
        for (int e = 0; e < 9; ++e) value.push_back(entry(i, j, e / 3, e % 3));
      }
      row_begin.push_back(static_cast<std::int32_t>(column.size()));
    }
  }

  // Entry (row, col) of block (i, j); alternating in sign, |entry| < 2048 up to 110 nodes.
  static std::int32_t entry(int i, int j, int row, int col) {
    const int a = 3 * i + row;
    const int b = 3 * j + col;
    const int low = std::min(a, b);
    const int distance = std::max(a, b) - low;
    const int magnitude = 6 * low + distance + 1;
    return (low + distance) % 2 == 0 ? magnitude : -magnitude;
  }

  hvp_matrix view() const {
    return {static_cast<std::uint32_t>(row_begin.size() - 1),
            static_cast<std::uint32_t>(column.size()), row_begin.data(), column.data(),
            value.data()};
  }

  std::vector<std::int32_t> row_begin = {0};
  std::vector<std::int32_t> column;
  std::vector<std::int32_t> value;
};

inline hvp_solver_config thesis_config() {
  hvp_solver_config config{};
  config.start = HVP_START_FROM_LAST;
  config.dynamic_scaling = true;
  config.headroom_bits = 3;
  config.iterations = 60;
  config.static_shift = 11;
  config.matrix_bits = 12;
  config.vector_bits = 16;
  config.coefficient_bits = 16;
  return config;
}

class DriverOnBoard : public ::testing::Test {
 protected:
  static constexpr int kNodes = 5;
  static constexpr std::size_t kUnknowns = 3 * kNodes;
  static constexpr std::uint64_t kTimeoutNs = 10'000'000;

  void open() {
    const hvp_bus bus = board.bus();
    ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  }
  void load() {
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    open();
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
    board.take_log();
  }

  ScriptedBoard board;
  ChainMatrix matrix{kNodes};
  std::array<std::uint32_t, 1024> scratch{};
  hvp_device device{};
  std::vector<std::int32_t> b = std::vector<std::int32_t>(kUnknowns, 7);
  std::vector<std::int32_t> u = std::vector<std::int32_t>(kUnknowns, 0);
};

}  // namespace hvp::test
