// One solve of the thesis' size, 500 nodes and 60 iterations, in the board's words and in double
// precision. The ratio within one run is what counts.
#include <array>

#include <benchmark/benchmark.h>

#include "models/fixed/reference_solver.h"
#include "tests/fixed/double_cg.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed {
namespace {

constexpr int kIterations = 60;

// 504 free nodes of 576.
const test::Body& body() {
  static const test::Body result = test::make_body({.cells_x = 7, .cells_y = 8, .cells_z = 7});
  return result;
}

void fixed_point(benchmark::State& state, Method method) {
  Settings s;
  s.method = method;
  s.iterations = kIterations;
  s.start = Start::zero;
  const QuantisedMatrix matrix = quantise(body().stiffness, s.matrix_bits);
  test::Random random(1);
  std::vector<std::int32_t> b;
  for (int i = 0; i < matrix.rows(); ++i) {
    b.push_back(static_cast<std::int32_t>(std::ldexp(random.symmetric(), 19 - s.rhs_shift())));
  }
  std::vector<std::int32_t> x(b.size());
  ReferenceSolver solver(s);
  for (auto _ : state) {
    benchmark::DoNotOptimize(solver.solve(matrix, {.b = b, .x = x}));
  }
  state.counters["nodes"] = matrix.block_rows();
  state.counters["x_real_time_500Hz"] = benchmark::Counter(
      2e-3 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void double_precision(benchmark::State& state, bool preconditioned) {
  const Eigen::SparseMatrix<double> a = body().stiffness.to_eigen();
  test::Random random(1);
  Eigen::VectorXd b(a.rows());
  for (double& entry : b) entry = random.symmetric();
  const std::array<int, 1> updates = {kIterations};
  for (auto _ : state) {
    benchmark::DoNotOptimize(test::double_cg(a, b, preconditioned, updates));
  }
  state.counters["nodes"] = static_cast<double>(a.rows()) / 3;
}

void quantising(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(quantise(body().stiffness, 12));
}

void moving_the_contact(benchmark::State& state) {
  const QuantisedMatrix original = quantise(body().stiffness, 12);
  QuantisedMatrix matrix = original;
  int node = 0;
  matrix.set_contact(node, 1000);
  for (auto _ : state) {
    matrix.restore_row(node, original.row(node));
    node = (node + 1) % matrix.block_rows();
    matrix.set_contact(node, 1000);
  }
}

BENCHMARK_CAPTURE(fixed_point, cg, Method::cg)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fixed_point, jacobi_pcg, Method::jacobi_pcg)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(double_precision, cg, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(double_precision, jacobi_pcg, true)->Unit(benchmark::kMicrosecond);
BENCHMARK(quantising)->Unit(benchmark::kMicrosecond);
BENCHMARK(moving_the_contact)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace hvp::fixed
