// One solve of 60 iterations by every kernel, by Eigen in double precision and in SystemC's
// fixed-point types. The ratios within one run are what counts: docs/fixed-point.md, "Fast path".
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <string>

#include <benchmark/benchmark.h>

#include "bench/fixed/bandwidth.h"
#include "bench/fixed/bodies.h"
#include "bench/fixed/sc_fixed_cg.h"
#include "models/fixed/fast/fast_solver.h"
#include "models/fixed/solver.h"
#include "models/fixed/system.h"

namespace hvp::fixed::bench {
namespace {

void count(::benchmark::State& state, int nodes) {
  state.counters["nodes"] = nodes;
  state.counters["x_real_time"] = ::benchmark::Counter(
      kPeriod * static_cast<double>(state.iterations()), ::benchmark::Counter::kIsRate);
}

// The matrix is read once an iteration, once for the first residual and once for the last.
void count_bytes(::benchmark::State& state, const Solver& solver) {
  const auto* fast = dynamic_cast<const fast::FastSolver*>(&solver);
  if (fast == nullptr) return;
  const auto bytes = static_cast<double>(fast->matrix_bytes());
  const double read = bytes * (kIterations + 2) * static_cast<double>(state.iterations());
  state.counters["matrix_bytes"] = bytes;
  state.SetBytesProcessed(static_cast<std::int64_t>(read));
  state.counters["of_bandwidth"] = ::benchmark::Counter(read / read_bandwidth(fast->matrix_bytes()),
                                                        ::benchmark::Counter::kIsRate);
}

void solve(::benchmark::State& state, Kernel kernel, Method method, int nodes) {
  const Settings s = settings(method);
  const QuantisedMatrix matrix = quantise(stiffness(nodes), s.matrix_bits);
  const std::vector<std::int32_t> b = right_hand_side(s, matrix.rows());
  std::vector<std::int32_t> x(b.size());
  const std::unique_ptr<Solver> solver = make_solver(s, kernel);
  solver->load(matrix);
  Report report;
  for (auto _ : state) ::benchmark::DoNotOptimize(report = solver->solve({.b = b, .x = x}));
  if (report.iterations != kIterations) state.SkipWithError("ended before its last iteration");
  count(state, matrix.block_rows());
  count_bytes(state, *solver);
}

template <typename Preconditioner>
void eigen_double(::benchmark::State& state, int nodes) {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const Matrix a = stiffness(nodes).to_eigen();
  const Settings s = settings(Method::cg);
  const std::vector<std::int32_t> words = right_hand_side(s, static_cast<int>(a.rows()));
  const Eigen::VectorXd b =
      Eigen::Map<const Eigen::VectorXi>(words.data(), a.rows()).cast<double>();
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner> solver(a);
  solver.setMaxIterations(kIterations);
  solver.setTolerance(0);
  Eigen::VectorXd x;
  for (auto _ : state) {
    x = solver.solve(b);
    ::benchmark::DoNotOptimize(x.data());
  }
  if (solver.iterations() != kIterations) state.SkipWithError("ended before its last iteration");
  count(state, static_cast<int>(a.rows() / 3));
}

void sc_fixed(::benchmark::State& state, int nodes) {
  const Settings s = settings(Method::cg);
  const QuantisedMatrix matrix = quantise(stiffness(nodes), s.matrix_bits);
  const std::vector<std::int32_t> b = right_hand_side(s, matrix.rows());
  std::vector<std::int32_t> expected(b.size());
  make_solver(s, Kernel::reference)->Solver::solve(matrix, {.b = b, .x = expected});
  std::vector<std::int32_t> x(b.size());
  ScFixedCg solver(matrix);
  for (auto _ : state) solver.solve(b, x, kIterations);
  if (x != expected) state.SkipWithError("gives other words than the reference");
  count(state, matrix.block_rows());
}

void bandwidth(::benchmark::State& state, std::size_t bytes) {
  double best = 0;
  for (auto _ : state) best = read_bandwidth(bytes);
  state.counters["buffer"] = static_cast<double>(bytes);
  state.counters["bytes_per_second"] = best;
}

void moving_the_contact(::benchmark::State& state, Kernel kernel) {
  const Settings s = settings(Method::jacobi_pcg);
  const QuantisedMatrix original = quantise(stiffness(500), s.matrix_bits);
  QuantisedMatrix matrix = original;
  const std::unique_ptr<Solver> solver = make_solver(s, kernel);
  solver->load(matrix);
  int node = 0;
  matrix.set_contact(node, 1000);
  solver->update(node);
  for (auto _ : state) {
    matrix.restore_row(node, original.row(node));
    solver->update(node);
    node = (node + 1) % matrix.block_rows();
    matrix.set_contact(node, 1000);
    solver->update(node);
  }
}

std::size_t packed_bytes(int nodes) {
  const Settings s = settings(Method::cg);
  const QuantisedMatrix matrix = quantise(stiffness(nodes), s.matrix_bits);
  fast::PackedMatrix packed;
  packed.load(matrix, s.vector_bits);
  return packed.bytes();
}

template <typename Function, typename... Arguments>
::benchmark::internal::Benchmark* add(const std::string& what, const Function& function,
                                      const Arguments&... arguments) {
  return ::benchmark::RegisterBenchmark(
             what.c_str(), [=](::benchmark::State& state) { function(state, arguments...); })
      ->Unit(::benchmark::kMicrosecond);
}

void add_all() {
  for (const int nodes : {500, 1000}) {
    const std::string size = "/" + std::to_string(nodes);
    for (const Kernel kernel : supported_kernels()) {
      add("solve/" + std::string(name(kernel)) + size, solve, kernel, Method::cg, nodes);
    }
    add("solve/eigen_double" + size, eigen_double<Eigen::IdentityPreconditioner>, nodes);
    add("solve/sc_fixed" + size, sc_fixed, nodes)->Iterations(2);
    for (const Kernel kernel : supported_kernels()) {
      add("solve_pcg/" + std::string(name(kernel)) + size, solve, kernel, Method::jacobi_pcg,
          nodes);
    }
    add("solve_pcg/eigen_double" + size, eigen_double<Eigen::DiagonalPreconditioner<double>>,
        nodes);
  }
  for (const int nodes : {2000, 5000, 10000, 20000, 50000}) {
    for (const Kernel kernel : {Kernel::portable, best_kernel()}) {
      add("solve/" + std::string(name(kernel)) + "/" + std::to_string(nodes), solve, kernel,
          Method::cg, nodes);
    }
  }
  for (const Kernel kernel : supported_kernels()) {
    add("contact/" + std::string(name(kernel)) + "/500", moving_the_contact, kernel);
  }
  add("quantise/500", [](::benchmark::State& state) {
    for (auto _ : state) ::benchmark::DoNotOptimize(quantise(stiffness(500), 12));
  });
  // The bandwidth of the cache that holds the matrix of 500 and 1000 nodes, and of memory.
  for (const int nodes : {500, 1000}) {
    add("bandwidth/matrix/" + std::to_string(nodes), [nodes](::benchmark::State& state) {
      bandwidth(state, packed_bytes(nodes));
    })->Iterations(1);
  }
  add("bandwidth/dram", bandwidth, std::size_t{1} << 30)->Iterations(1);
}

}  // namespace
}  // namespace hvp::fixed::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  hvp::fixed::bench::add_all();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
