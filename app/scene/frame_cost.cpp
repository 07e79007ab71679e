#include "app/scene/frame_cost.h"

#include <fmt/format.h>

#include "models/host/costs.h"
#include "models/link/interconnect.h"

namespace hvp::app {

namespace {
struct MovedVectors {
  std::int64_t send_ps;
  std::int64_t receive_ps;
};

MovedVectors moved_over(const link::PcieInterconnect& link, vp::Transfer::Method method,
                        std::int64_t b, std::int64_t u) {
  using Method = vp::Transfer::Method;
  if (method == Method::dma) return {link.dma_read(b).latency_ps, link.dma_write(u).latency_ps};
  return {link.processor_write(b, method != Method::programmed_io).latency_ps,
          link.processor_read(u).latency_ps};
}

// The time of a transfer that is alone on the bus, without doorbells and interrupts.
MovedVectors moved_vectors(const Scenario& s, int nodes) {
  using Method = vp::Transfer::Method;
  const std::int64_t unknowns = std::int64_t{3} * nodes;
  const auto bytes = [&](int bits) {
    return link::Payload{0, 0, bits, s.transfer.packed}.bytes(unknowns);
  };
  const std::int64_t b = bytes(s.solver.residual_bits());
  const std::int64_t u = bytes(s.solver.vector_bits);
  if (s.bus.pcie) return moved_over(link::PcieInterconnect(*s.bus.pcie), s.transfer.method, b, u);
  const link::Pci& pci = s.bus.pci;
  switch (s.transfer.method) {
    case Method::bursts:
      return {pci.write_ps(b), pci.read_ps(u)};
    case Method::programmed_io:
      return {b / 4 * pci.write_ps(4), u / 4 * pci.read_ps(4)};
    case Method::write_combined_io:
      return {pci.write_ps(b), u / 4 * pci.read_ps(4)};
    case Method::dma:
      return {pci.read_wire_ps(b), pci.write_wire_ps(u)};
  }
  return {};
}

}  // namespace

std::vector<FrameStep> frame_steps(const Scene& scene) {
  const Scenario& s = scene.scenario();
  const bool takes_time = s.fidelity.accelerator != vp::Timing::untimed;
  const std::int64_t clocks = takes_time ? scene.solve_cycles().total() : 0;
  return frame_steps(scene, scene.body().active_nodes(), clocks * s.accelerator.clock_period_ps());
}

std::vector<FrameStep> frame_steps(const Scene& scene, int nodes, std::int64_t solve_ps) {
  const Scenario& s = scene.scenario();
  const double grown = static_cast<double>(nodes) / scene.body().active_nodes();
  const bool host_takes_time = s.fidelity.host != vp::Timing::untimed;
  const bool bus_takes_time = s.fidelity.bus != vp::Timing::untimed;
  std::vector<FrameStep> steps;
  for (const host::Step& step : scene.computation().steps()) {
    if (step.where == host::Step::Where::board) {
      const MovedVectors moved = moved_vectors(s, nodes);
      steps.push_back({"send b", bus_takes_time ? moved.send_ps : 0, step.times});
      steps.push_back({"solve", solve_ps, step.times});
      steps.push_back({"receive U", bus_takes_time ? moved.receive_ps : 0, step.times});
      continue;
    }
    const double rate = step.where == host::Step::Where::solver ? s.host.solver_speed() : 1;
    const std::int64_t ps = host_takes_time ? s.host.compute_ps(step.operations / rate * grown) : 0;
    steps.push_back({step.what, ps, step.times, step.after_force});
  }
  return steps;
}

std::int64_t latency_ps(const std::vector<FrameStep>& steps) {
  std::int64_t sum = 0;
  for (const FrameStep& step : steps) sum += step.after_force ? 0 : step.times * step.ps;
  return sum;
}

std::int64_t frame_ps(const std::vector<FrameStep>& steps) {
  std::int64_t sum = 0;
  for (const FrameStep& step : steps) sum += step.times * step.ps;
  return sum;
}

}  // namespace hvp::app
