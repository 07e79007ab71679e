// The product with which thesis Table 6.3 compares the accelerator, on a PC's core: double
// precision, compressed rows, from the caches and from memory, and in blocks of 3 × 3.
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "tables/pc/crs_product.h"

namespace hvp::tables {
namespace {

void count(::benchmark::State& state, std::size_t nonzeros) {
  state.counters["nonzeros"] = static_cast<double>(nonzeros);
  state.counters["MFLOPS"] = ::benchmark::Counter(
      2e-6 * static_cast<double>(nonzeros) * static_cast<double>(state.iterations()),
      ::benchmark::Counter::kIsRate);
}

void crs(::benchmark::State& state) {
  const CrsMatrix a = repeated(crs_of(thesis_stiffness()), static_cast<int>(state.range(0)));
  const std::vector<double> x(a.rows(), 1.0);
  std::vector<double> y(a.rows());
  for (auto _ : state) {
    a.multiply(x, y);
    ::benchmark::DoNotOptimize(y.data());
    ::benchmark::ClobberMemory();
  }
  count(state, a.nonzeros());
}

void blocks(::benchmark::State& state) {
  const sparse::BlockMatrix a = thesis_stiffness();
  const std::vector<double> x(static_cast<std::size_t>(a.rows()), 1.0);
  std::vector<double> y(x.size());
  for (auto _ : state) {
    a.multiply(x, y);
    ::benchmark::DoNotOptimize(y.data());
    ::benchmark::ClobberMemory();
  }
  count(state, a.value.size());
}

BENCHMARK(crs)->ArgName("copies")->Arg(1)->Arg(120);
BENCHMARK(blocks);

}  // namespace
}  // namespace hvp::tables
