// The scaling of the finite elements: boxes of 1k to 64k nodes, six tetrahedra a cell. Assembly
// must grow linearly with the tetrahedra (a small box has fewer of them a node: its surface); the
// line BigO is the fitted cost of one, RMS how far the fit is off.

#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/fem/assembly.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/locking.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"

namespace hvp::fem {
namespace {

// Nodes along an edge: 10³ = 1000, 16³ = 4096, 25³ = 15 625, 40³ = 64 000.
constexpr int kEdges[] = {10, 16, 25, 40};

mesh::TetMesh cube(int edge_nodes) {
  return structured_box({1, 1, 1}, {edge_nodes - 1, edge_nodes - 1, edge_nodes - 1});
}

void edges(benchmark::internal::Benchmark* benchmark) {
  for (const int edge : kEdges) benchmark->Arg(edge);
}

void report(benchmark::State& state, const mesh::TetMesh& mesh) {
  const std::size_t nodes = mesh.nodes.size();
  const auto tetrahedra = static_cast<double>(mesh.tetrahedra.size());
  state.SetComplexityN(static_cast<benchmark::IterationCount>(mesh.tetrahedra.size()));
  state.counters["nodes"] = static_cast<double>(nodes);
  state.counters["per_tetrahedron"] = benchmark::Counter(
      tetrahedra, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void assemble_k(benchmark::State& state) {
  const mesh::TetMesh mesh = cube(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(assemble_stiffness(mesh, Material{}));
  report(state, mesh);
}
BENCHMARK(assemble_k)->Apply(edges)->Complexity(benchmark::oN)->Unit(benchmark::kMillisecond);

void assemble_consistent_m(benchmark::State& state) {
  const mesh::TetMesh mesh = cube(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(assemble_mass(mesh, Material{}, MassKind::consistent));
  }
  report(state, mesh);
}
BENCHMARK(assemble_consistent_m)
    ->Apply(edges)
    ->Complexity(benchmark::oN)
    ->Unit(benchmark::kMillisecond);

void newmark_step_without_solve(benchmark::State& state) {
  const mesh::TetMesh mesh = cube(static_cast<int>(state.range(0)));
  Newmark newmark(assemble_stiffness(mesh, Material{}),
                  assemble_mass(mesh, Material{}, MassKind::lumped), Dynamics{}, 2e-3);
  const std::vector<double> f(3 * mesh.nodes.size(), 1.0);
  std::vector<double> f_hat(f.size());
  for (auto _ : state) {
    newmark.predict();
    newmark.rhs(f, f_hat);
    newmark.update(newmark.displacement());
    benchmark::DoNotOptimize(f_hat.data());
  }
  report(state, mesh);
}
BENCHMARK(newmark_step_without_solve)
    ->Apply(edges)
    ->Complexity(benchmark::oN)
    ->Unit(benchmark::kMicrosecond);

// The reference grows faster than linearly (nested fronts in three dimensions); it is for the
// sizes a board can hold.
Body anchored_cube(int edge_nodes) {
  mesh::TetMesh mesh = cube(edge_nodes);
  std::vector<int> floor;
  for (int i = 0; i < edge_nodes * edge_nodes; ++i) floor.push_back(i);
  return Body(std::move(mesh), Material{}, floor, AnchorTreatment::removed);
}

void reference_factorisation(benchmark::State& state) {
  const Body body = anchored_cube(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(DirectSolver(body.stiffness()));
  report(state, body.mesh());
}
BENCHMARK(reference_factorisation)->Arg(6)->Arg(8)->Arg(10)->Unit(benchmark::kMillisecond);

void reference_solve(benchmark::State& state) {
  const Body body = anchored_cube(static_cast<int>(state.range(0)));
  const DirectSolver solver(body.stiffness());
  std::vector<double> x(body.load().size(), 1.0);
  for (auto _ : state) {
    solver.solve(x, x);
    benchmark::DoNotOptimize(x.data());
  }
  report(state, body.mesh());
}
BENCHMARK(reference_solve)->Arg(6)->Arg(8)->Arg(10)->Unit(benchmark::kMicrosecond);

void locking_measurement(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(cantilever_ratio(0.49, static_cast<int>(state.range(0))));
  }
}
BENCHMARK(locking_measurement)
    ->DenseRange(2, most_locking_cells(Elements::linear), 2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hvp::fem
