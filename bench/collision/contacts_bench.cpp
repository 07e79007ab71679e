// The forces of a frame by the number of contacts, of proxies and of patches, on the top of a block
// of about 500 nodes: what a frame's forces take beside one probe's, and what set-up takes.

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/collision/contact.h"
#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "models/host/gliding_contact.h"

namespace hvp::host {
namespace {

constexpr double kRadius = 3e-3;  // m
const Eigen::Vector3d kSize(0.08, 0.08, 0.04);

fem::Body block() {
  mesh::TetMesh mesh = fem::structured_box(kSize, {8, 8, 4});
  std::vector<int> floor;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) floor.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), {}, floor, fem::AnchorTreatment::removed);
}

GlideTables tables_of(const fem::Body& body, collision::ContactKind kind, std::size_t probes) {
  return {body, body.stiffness(), false,
          true, {.kind = kind},   std::vector<double>(probes, kRadius)};
}

// Tips on a circle in the middle of the top, 2 mm deep, that turn by a tenth of a millimetre a
// frame.
void forces(benchmark::State& state, collision::ContactKind kind) {
  const auto probes = static_cast<std::size_t>(state.range(0));
  const fem::Body body = block();
  const GlideTables tables = tables_of(body, kind, probes);
  GlidingContact contact(body, tables);
  std::vector<Eigen::Vector3d> tips(probes);
  double turn = 0;
  const auto place = [&] {
    for (std::size_t i = 0; i < probes; ++i) {
      const double angle =
          turn + 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(probes);
      tips[i] = {0.04 + 0.02 * std::cos(angle), 0.04 + 0.02 * std::sin(angle), kSize.z() - 2e-3};
    }
  };
  double operations = 0;
  for ([[maybe_unused]] auto _ : state) {
    turn += 1e-4 / 0.02;
    place();
    contact.look(tips, tables.free_displacement);
    contact.solve(tables.free_displacement);
    benchmark::DoNotOptimize(contact.forces().data());
    operations += contact.look_operations() + contact.solve_operations();
  }
  state.counters["operations"] = operations / static_cast<double>(state.iterations());
  state.counters["rate"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(forces, proxy, collision::ContactKind::proxy)->DenseRange(1, 8);
BENCHMARK_CAPTURE(forces, patch, collision::ContactKind::patch)->DenseRange(1, 8);

void set_up(benchmark::State& state, collision::ContactKind kind) {
  const fem::Body body = block();
  for ([[maybe_unused]] auto _ : state) {
    const GlideTables tables = tables_of(body, kind, 1);
    benchmark::DoNotOptimize(tables.bytes());
  }
}
BENCHMARK_CAPTURE(set_up, proxy, collision::ContactKind::proxy)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(set_up, patch, collision::ContactKind::patch)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hvp::host
