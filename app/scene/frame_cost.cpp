#include "app/scene/frame_cost.h"

#include <fmt/format.h>

#include "models/host/costs.h"
#include "models/link/interconnect.h"
#include "models/time/picoseconds.h"

namespace hvp::app {

namespace {

using Method = vp::Transfer::Method;

std::int64_t payload_bytes(const Scenario& s, int bits, std::int64_t elements) {
  return link::Payload{0, 0, bits, s.transfer.packed}.bytes(elements);
}

// The times of transfers to and from the board that are alone on the bus, without doorbells and
// interrupts.
std::int64_t send_ps(const Scenario& s, std::int64_t bytes) {
  const Method method = s.transfer.method;
  if (s.bus.pcie) {
    const link::PcieInterconnect link(*s.bus.pcie);
    if (method == Method::dma) return link.dma_read(bytes).latency_ps;
    return link.processor_write(bytes, method != Method::programmed_io).latency_ps;
  }
  const link::Pci& pci = s.bus.pci;
  switch (method) {
    case Method::bursts:
    case Method::write_combined_io:
      return pci.write_ps(bytes);
    case Method::programmed_io:
      return bytes / 4 * pci.write_ps(4);
    case Method::dma:
      return pci.read_wire_ps(bytes);
  }
  return 0;
}

std::int64_t receive_ps(const Scenario& s, std::int64_t bytes) {
  const Method method = s.transfer.method;
  if (s.bus.pcie) {
    const link::PcieInterconnect link(*s.bus.pcie);
    if (method == Method::dma) return link.dma_write(bytes).latency_ps;
    return link.processor_read(bytes).latency_ps;
  }
  const link::Pci& pci = s.bus.pci;
  switch (method) {
    case Method::bursts:
      return pci.read_ps(bytes);
    case Method::programmed_io:
    case Method::write_combined_io:
      return bytes / 4 * pci.read_ps(4);
    case Method::dma:
      return pci.write_wire_ps(bytes);
  }
  return 0;
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
  const host::GlideTables* glide = scene.glide();
  const std::vector<host::Step> of_frame =
      glide == nullptr ? scene.computation().steps()
                       : scene.computation().steps_with_loads(glide->typical_operations(),
                                                              glide->free_displacement.empty());
  for (const host::Step& step : of_frame) {
    if (step.where == host::Step::Where::board) {
      const std::int64_t unknowns = std::int64_t{3} * nodes;
      const std::int64_t b = payload_bytes(s, s.solver.residual_bits(), unknowns);
      const std::int64_t u = payload_bytes(s, s.solver.vector_bits, unknowns);
      const bool after = step.after_force;
      steps.push_back({"send b", bus_takes_time ? send_ps(s, b) : 0, step.times, after});
      steps.push_back({"solve", solve_ps, step.times, after});
      steps.push_back({"receive U", bus_takes_time ? receive_ps(s, u) : 0, step.times, after});
      continue;
    }
    const std::int64_t alone =
        step.where == host::Step::Where::solver
            ? to_picoseconds(s.host.solve_s(step.work, step.memory))
        : step.where == host::Step::Where::core
            ? to_picoseconds(s.host.core_solve_s(step.work, step.memory.working_set))
            : s.host.compute_ps(step.operations * grown);
    const std::int64_t ps = host_takes_time ? alone : 0;
    steps.push_back({step.what, ps, step.times, step.after_force});
  }
  return steps;
}

std::vector<FrameStep> renewal_steps(const Scene& scene) {
  const Scenario& s = scene.scenario();
  if (!s.object.renewal().present()) return {};
  const host::FrameComputation& computation = scene.computation();
  const auto assemble_ps = s.host.compute_ps(computation.typical_renew_operations());
  if (!scene.has_board()) {
    const host::FrameMethod& method = computation.method();
    std::vector<FrameStep> steps = {{"assemble: tangents", assemble_ps, 1, true}};
    const host::SolveMemory memory = method.memory();
    if (const host::SolveWork work = method.set_up_work(); work.operations() > 0) {
      steps.push_back({"assemble: the solver's set-up",
                       to_picoseconds(s.host.core_solve_s(work, memory.set_up)), 1, true});
    }
    if (s.host.gpu) {
      steps.push_back(
          {"load values: to the GPU", to_picoseconds(s.host.gpu->load_s(memory.kept)), 1, true});
    }
    if (s.fidelity.host == vp::Timing::untimed) {
      for (FrameStep& step : steps) step.ps = 0;
    }
    return steps;
  }
  const std::size_t entries = computation.board().matrix().value.size();
  std::vector<FrameStep> steps;
  const auto add = [&](const char* what, vp::Timing level, std::int64_t ps) {
    steps.push_back({what, level == vp::Timing::untimed ? 0 : ps, 1, true});
  };
  add("assemble: tangents, in words", s.fidelity.host, assemble_ps);
  add("load values: the driver", s.fidelity.host, to_picoseconds(s.host.driver_s(entries)));
  add("send the values", s.fidelity.bus,
      send_ps(s, payload_bytes(s, s.solver.matrix_bits, static_cast<std::int64_t>(entries))));
  add("load values: the board", s.fidelity.accelerator,
      scene.board().load(s.solver) * s.accelerator.clock_period_ps());
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
