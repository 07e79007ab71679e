// The cost of the board in a program's own process: register accesses, and a job of one node
// through the driver. SystemC elaborates once in a process: HVP_SCENARIO is another scenario's file
// than thesis.toml, for instance pcie-msi.toml; bench_board_watched is the same with
// hvp_board_options.check.

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include <benchmark/benchmark.h>

#include "app/board/hvp_board.h"

namespace {

constexpr hvp_board_options kOptions = {
    .overrides = nullptr,
    .override_count = 0,
    .trace = nullptr,
    .check = HVP_WATCHED,
    .record = nullptr,
};

hvp_board* board() {
  static hvp_board* const opened = [] {
    const char* chosen = std::getenv("HVP_SCENARIO");
    const char* scenario = chosen != nullptr ? chosen : HVP_SCENARIOS "/thesis.toml";
    std::array<char, 256> why{};
    hvp_board* const made = hvp_board_open(scenario, &kOptions, why.data(), why.size());
    if (made == nullptr) {
      std::fprintf(stderr, "%s\n", why.data());
      std::exit(2);
    }
    return made;
  }();
  return opened;
}

void register_read(benchmark::State& state) {
  const hvp_bus* bus = hvp_board_bus(board());
  for (auto _ : state) benchmark::DoNotOptimize(bus->read32(bus->context, 0));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(register_read);

// INTERRUPT_ENABLE.
void register_write(benchmark::State& state) {
  const hvp_bus* bus = hvp_board_bus(board());
  for (auto _ : state) bus->write32(bus->context, 0x2c, 0);
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(register_write);

void configuration_read(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(hvp_board_config_read(board(), 0, 4));
}
BENCHMARK(configuration_read);

void job(benchmark::State& state) {
  static constexpr std::array<std::int32_t, 2> kRowBegin = {0, 1};
  static constexpr std::array<std::int32_t, 1> kColumn = {0};
  static constexpr std::array<std::int32_t, 9> kValue = {64, 0, 0, 0, 32, 0, 0, 0, 16};
  hvp_device device{};
  std::array<std::uint32_t, 16> scratch{};
  hvp_solver_config config{};
  config.method = HVP_METHOD_JACOBI_PCG;
  config.iterations = 4;
  config.matrix_bits = 12;
  config.vector_bits = 16;
  config.coefficient_bits = 16;
  config.dynamic_scaling = true;
  const hvp_matrix k = {1, 1, kRowBegin.data(), kColumn.data(), kValue.data()};
  if (hvp_open(&device, hvp_board_bus(board()), scratch.data(), scratch.size()) != HVP_OK ||
      hvp_configure(&device, &config) != HVP_OK || hvp_load_matrix(&device, &k) != HVP_OK) {
    state.SkipWithError("the board cannot be set up");
    return;
  }
  std::array<std::int32_t, 3> b = {640, 640, 640};
  std::array<std::int32_t, 3> u{};
  for (auto _ : state) {
    if (hvp_solve(&device, b.data(), u.data(), u.size(), 100'000'000) != HVP_OK) {
      state.SkipWithError("a job failed");
      return;
    }
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(job);

}  // namespace
