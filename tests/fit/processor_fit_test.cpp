#include "models/fit/processor_fit.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"

namespace hvp::fit::processor_fit_test {
namespace {

host::Processor made_up() {
  return {.call_s = 2e-7,
          .dense_flops = 20e9,
          .single_flops = 50e9,
          .sparse_flops = 3e9,
          .triangular_flops = 5e9,
          .caches = {{{32e3, 100e9}, {1e6, 60e9}, {32e6, 30e9}}},
          .memory_bandwidth = 12e9};
}

// Solves of several sizes whose times are a processor's own.
std::vector<SolveTime> times_of(const host::Processor& p) {
  std::vector<SolveTime> times;
  int place = 0;
  for (const double n : {20.0, 60.0, 150.0, 400.0, 1500.0, 5000.0, 8000.0}) {
    const std::vector<std::pair<host::SolveWork, double>> works = {
        {{.dense = 2 * n * n, .bytes = 8 * n * n}, 8 * n * n},
        {{.dense_single = 2 * n * n, .bytes = 4 * n * n}, 4 * n * n},
        {{.sparse = 80 * n, .bytes = 350 * n}, 350 * n},
        {{.triangular = 30 * n * n, .bytes = 20 * n}, 20 * n},
        {{.dense = 3 * n, .bytes = 16 * n}, 16 * n}};
    for (const auto& [work, set] : works) {
      times.push_back(
          {"made up", static_cast<int>(n), work, set, p.seconds(work, set), place % 2 == 1});
    }
    ++place;
  }
  return times;
}

TEST(ProcessorFit, FindsWhatTimesWereMadeOf) {
  const host::Processor p = made_up();
  host::Processor start = p;
  start.call_s = 1e-6;
  start.dense_flops *= 3;
  start.single_flops /= 2;
  start.sparse_flops *= 2;
  start.triangular_flops /= 3;
  for (auto& cache : start.caches) cache.bandwidth *= 2;
  start.memory_bandwidth *= 2;
  const ProcessorFit found = fit_processor(times_of(p), start);
  EXPECT_LT(found.worst_fitted, 1.02);
  EXPECT_LT(found.worst_held_out, 1.05);
  EXPECT_NEAR(found.processor.sparse_flops / p.sparse_flops, 1, 0.1);
  EXPECT_NEAR(found.processor.triangular_flops / p.triangular_flops, 1, 0.05);
  EXPECT_NEAR(found.processor.memory_bandwidth / p.memory_bandwidth, 1, 0.1);
  EXPECT_EQ(found.processor.caches[1].size_bytes, 1e6);
}

// A time that something disturbed does not bend the others.
TEST(ProcessorFit, ADisturbedTimeIsOneOfMany) {
  const host::Processor p = made_up();
  std::vector<SolveTime> times = times_of(p);
  times.front().seconds *= 20;
  const ProcessorFit found = fit_processor(times, p);
  EXPECT_LT(found.worst_held_out, 1.2);
}

// The times that one machine took: of two sizes that the fit has not seen.
TEST(ProcessorFit, PredictsSizesOfARealMachine) {
  std::ifstream file(HVP_HOST_SOLVES);
  std::string line;
  std::getline(file, line);
  std::vector<SolveTime> times;
  while (std::getline(file, line)) {
    const auto cells = files::csv_cells(line);
    ASSERT_EQ(cells.size(), 11U);
    const auto number = [&](std::size_t i) { return std::stod(std::string(cells[i])); };
    times.push_back({std::string(cells[0]),
                     static_cast<int>(number(1)),
                     {number(2), number(3), number(4), number(5), number(6)},
                     number(7),
                     number(8),
                     number(10) > 0});
  }
  ASSERT_EQ(times.size(), 40U);
  host::Processor start = host::built_in(host::ProcessorModel::desktop_2026);
  start.caches.back().size_bytes = 32 * 1024 * 1024;
  const ProcessorFit found = fit_processor(times, start);
  int held_out = 0;
  int close = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!times[i].held_out) continue;
    ++held_out;
    const double ratio = found.predictions[i].ratio;
    if (ratio > 1 / 1.2 && ratio < 1.2) ++close;
  }
  EXPECT_EQ(held_out, 16);
  EXPECT_GE(close, 13);
  EXPECT_LT(found.worst_held_out, 1.35);
  // The machine whose times these are is the built-in one.
  const host::Processor& built_in = host::built_in(host::ProcessorModel::desktop_2026);
  for (const SolveTime& time : times) {
    const double ratio = built_in.seconds(time.work, time.working_set) / time.seconds;
    EXPECT_GT(ratio, 0.5) << time.solver << " of " << time.unknowns;
    EXPECT_LT(ratio, 2) << time.solver << " of " << time.unknowns;
  }
}

TEST(ProcessorFit, TooFewOrImpossibleTimesAreRefused) {
  std::vector<SolveTime> times = times_of(made_up());
  const std::vector<SolveTime> few(times.begin(), times.begin() + 7);
  EXPECT_THROW(fit_processor(few, made_up()), InputError);
  times[3].seconds = 0;
  EXPECT_THROW(fit_processor(times, made_up()), InputError);
}

}  // namespace
}  // namespace hvp::fit::processor_fit_test
