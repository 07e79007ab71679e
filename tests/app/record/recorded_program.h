#pragma once

// A program with the board in it that is recorded, and the replay of it by `hvp replay`.
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "app/record/record.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::record::test {

class RecordedProgram : public testing::Test {
 protected:
  void open(const std::vector<const char*>& overrides = {}, bool records = true) {
    const std::string file = (place.path() / "a.bin").string();
    const std::string scenario = cli::scenario("thesis.toml").string();
    const hvp_board_options options = {overrides.data(), overrides.size(), nullptr, false,
                                       records ? file.c_str() : nullptr};
    board = hvp_board_open(scenario.c_str(), &options, why.data(), why.size());
    ASSERT_NE(board, nullptr) << why.data();
  }
  // One node with a diagonal matrix.
  void load(hvp_device& device, std::uint32_t iterations = 4) {
    ASSERT_EQ(hvp_open(&device, hvp_board_bus(board), scratch.data(), scratch.size()), HVP_OK);
    hvp_solver_config config{};
    config.method = HVP_METHOD_JACOBI_PCG;
    config.iterations = iterations;
    config.matrix_bits = 12;
    config.vector_bits = 16;
    config.coefficient_bits = 16;
    config.dynamic_scaling = true;
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    const hvp_matrix k = {1, 1, row_begin.data(), column.data(), value.data()};
    ASSERT_EQ(hvp_load_matrix(&device, &k), HVP_OK);
  }
  void solve(hvp_device& device, hvp_status expected = HVP_OK) {
    ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), expected);
    if (expected != HVP_OK) return;
    EXPECT_EQ(u, (std::array<std::int32_t, 3>{10, 20, 40}));
  }
  void close() {
    hvp_board_close(board);
    board = nullptr;
  }
  void TearDown() override { close(); }

  // `hvp replay a.bin` with more words.
  cli::Ended replay(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"replay", "a.bin"};
    words.insert(words.end(), more.begin(), more.end());
    return cli::hvp(place.path(), words);
  }
  nlohmann::json figures(int status, std::vector<std::string> more = {}) {
    more.emplace_back("--json");
    const cli::Ended ended = replay(more);
    EXPECT_EQ(ended.status, status) << ended.out << ended.err;
    return nlohmann::json::parse(ended.out, nullptr, false);
  }
  Record recorded() const { return read_record(place.path() / "a.bin"); }

  ScratchDirectory place;
  std::array<char, 256> why{};
  hvp_board* board = nullptr;
  std::array<std::uint32_t, 16> scratch{};
  std::array<std::int32_t, 2> row_begin = {0, 1};
  std::array<std::int32_t, 1> column = {0};
  std::array<std::int32_t, 9> value = {64, 0, 0, 0, 32, 0, 0, 0, 16};
  std::array<std::int32_t, 3> b = {640, 640, 640};
  std::array<std::int32_t, 3> u{};
};

}  // namespace hvp::record::test
