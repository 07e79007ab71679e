// The internal forces and the tangent of each material law in a box of about 500 nodes, an element,
// beside K·u, which is what a linear body takes. Every node is displaced by up to a tenth of a
// cell.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "models/tissue/elastic_body.h"

namespace hvp::tissue {
namespace {

constexpr double kCell = 0.005;  // m

fem::Body box() {
  mesh::TetMesh mesh = fem::structured_box({7 * kCell, 7 * kCell, 7 * kCell}, {7, 7, 7});
  std::vector<int> anchored;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) anchored.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), {}, anchored, fem::AnchorTreatment::removed);
}

std::vector<double> displacements(const fem::Body& body) {
  std::vector<double> u(body.load().size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] = 0.1 * kCell * (static_cast<double>(i * 7919 % 2001) / 1000 - 1);
  }
  return u;
}

void report(benchmark::State& state, const fem::Body& body, const Operations& operations) {
  const auto elements = static_cast<double>(body.mesh().tetrahedra.size());
  state.counters["per_element"] = benchmark::Counter(
      elements, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["operations_an_element"] = operations.total() / elements;
  state.counters["rate"] =
      benchmark::Counter(operations.total(), benchmark::Counter::kIsIterationInvariantRate);
}

void multiply_k(benchmark::State& state) {
  const fem::Body body = box();
  const std::vector<double> u = displacements(body);
  std::vector<double> f(u.size());
  for ([[maybe_unused]] auto _ : state) {
    body.stiffness().multiply(u, f);
    benchmark::DoNotOptimize(f.data());
  }
  report(state, body, {.add_multiply = 18.0 * static_cast<double>(body.stiffness().blocks())});
}
BENCHMARK(multiply_k);

void forces(benchmark::State& state) {
  const fem::Body body = box();
  const ElasticBody elastic(body, static_cast<LawKind>(state.range(0)));
  const std::vector<double> u = body.expand(displacements(body));
  std::vector<double> f(u.size());
  Deformation found;
  for ([[maybe_unused]] auto _ : state) {
    found = elastic.internal_forces(u, f);
    benchmark::DoNotOptimize(f.data());
  }
  report(state, body, found.operations);
  state.SetLabel(std::string(law_names()[static_cast<std::size_t>(state.range(0))].first));
}
BENCHMARK(forces)->DenseRange(0, 5);

void tangent(benchmark::State& state) {
  const fem::Body body = box();
  const ElasticBody elastic(body, static_cast<LawKind>(state.range(0)));
  const std::vector<double> u = body.expand(displacements(body));
  sparse::BlockMatrix k = body.stiffness();
  Deformation found;
  for ([[maybe_unused]] auto _ : state) {
    found = elastic.tangent(u, Linearisation::exact, k);
    benchmark::DoNotOptimize(k.value.data());
  }
  report(state, body, found.operations);
  state.SetLabel(std::string(law_names()[static_cast<std::size_t>(state.range(0))].first));
}
BENCHMARK(tangent)->DenseRange(0, 5);

}  // namespace
}  // namespace hvp::tissue
