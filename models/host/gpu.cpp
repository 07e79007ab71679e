#include "models/host/gpu.h"

#include <algorithm>
#include <string>

#include "models/config/effects.h"

namespace hvp::host {

using config::Dimension;

GpuLatencies::GpuLatencies() {
  mean_s = 0.5e-6;
  maximum_s = 25e-6;
}

void GpuLatencies::declare(config::Visitor& v) {
  TimeDistribution::declare(
      v, {.kind = "assumed: few long ones; an empty kernel has a mean of 6.5 and a peak of 31 us "
                  "(E-ELT real-time control, docs/host-solvers.md)",
          .mean = "assumed: what the mean of an empty kernel is above its usual time",
          .maximum = "the peak of an empty kernel, 31 us, less its usual time"});
}

std::vector<config::Need> Gpu::needs() {
  return {config::need_timed_host(),
          {"host.solver",
           {"cg", "inverse", "superposition"},
           "in triangular solves a GPU waits for itself more often than this model counts"}};
}

void Gpu::declare(config::Visitor& v) {
  const auto time = [&](std::string_view name, double& value, std::string_view what,
                        std::string_view source) {
    v.quantity(name, value, Dimension::time, config::between(0, 1e-2), {what, source});
  };
  const auto of_launch = v.variant(
      "launch", launch,
      {{"plain", Launch::plain}, {"graph", Launch::graph}, {"persistent", Launch::persistent}},
      {"plain: the host launches every kernel; graph: all at once; persistent: one kernel stays "
       "and "
       "looks for its load",
       "what CUDA's examples do for many small kernels"});
  of_launch.only({Launch::plain}, [&] {
    time("plain_start", plain_start_s, "of the first launch, and the wait for the last kernel",
         "measured by others: ocannl#488, a laptop's RTX 5070 Ti");
    time("plain_kernel", plain_kernel_s, "of each kernel, however small",
         "estimated: 1.63 graph_kernel, as NGSolve's CG with 1961 unknowns has it on an H100");
  });
  of_launch.only({Launch::graph}, [&] {
    time("graph_start", graph_start_s, "of a graph's launch",
         "measured by others: ocannl#488, a laptop's RTX 5070 Ti");
    time("graph_kernel", graph_kernel_s, "of each kernel in it, however small",
         "estimated: 60 iterations of CG in 1.4 to 2 ms");
  });
  of_launch.only({Launch::persistent}, [&] {
    time("persistent_start", persistent_start_s, "from the host to the GPU and back",
         "measured by others: gdrcopy's README, a B200");
    time("barrier", barrier_s, "of a wait of all workers for each other",
         "estimated: 60 iterations of CG in one kernel in 200 to 300 us (PERKS, ICS 2023)");
  });
  const auto of_memory = v.variant(
      "memory", memory, {{"copies", Memory::copies}, {"unified", Memory::unified}},
      {"copies: load and solution are copied there and back; unified: one reads the other's memory",
       "a card on PCI Express"});
  of_memory.only({Memory::copies}, [&] {
    time("copy", copy_s, "of each copy, beside its bytes",
         "measured by others: 6 to 7 us, gdrcopy's README");
  });
  const auto bandwidth = [&](std::string_view name, double& value, std::string_view what,
                             std::string_view source) {
    v.quantity(name, value, Dimension::bandwidth, config::between(1e6, 1e15), {what, source});
  };
  bandwidth("link_bandwidth", link_bandwidth, "of load and solution between host and GPU",
            "measured by others: 4 kB in 0.27 us, gdrcopy's README");
  v.quantity("cache_size", cache_bytes, Dimension::data_size, config::between(0, 1e12),
             {"what the GPU's last cache has room for", "NVIDIA's data sheet of the H100"});
  bandwidth("cache_bandwidth", cache_bandwidth, "of that cache",
            "measured by others: H100, PMC10448217");
  bandwidth("memory_bandwidth", memory_bandwidth, "of the GPU's memory",
            "NVIDIA's data sheet of the H100");
  const auto rate = [&](std::string_view name, double& value, std::string_view what) {
    v.quantity(name, value, Dimension::throughput, config::between(1e6, 1e16),
               {what, "NVIDIA's data sheet of the H100, its peak"});
  };
  rate("double_rate", double_flops, "operations a second in double precision");
  rate("single_rate", single_flops, "operations a second in single precision");
  v.effect("latencies", latencies,
           {"each solve takes a time longer that is drawn",
            random::drawn("after each solve on the GPU", latencies), needs()});
}

double Gpu::seconds(const SolveWork& work, const SolveMemory& moved) const {
  const double calls = std::max(1, work.calls);
  const double waits = std::max(calls, static_cast<double>(work.barriers));
  double seconds = calls * (moved.right_hand_side + moved.solution) / link_bandwidth;
  if (memory == Memory::copies) seconds += 2 * calls * copy_s;
  switch (launch) {
    case Launch::plain:
      seconds += calls * plain_start_s + waits * plain_kernel_s;
      break;
    case Launch::graph:
      seconds += calls * graph_start_s + waits * graph_kernel_s;
      break;
    case Launch::persistent:
      seconds += calls * persistent_start_s + waits * barrier_s;
      break;
  }
  seconds += work.bytes / (moved.working_set <= cache_bytes ? cache_bandwidth : memory_bandwidth);
  return seconds + work.dense_single / single_flops +
         (work.operations() - work.dense_single) / double_flops;
}

double Gpu::load_s(double bytes) const {
  return bytes / link_bandwidth + (memory == Memory::copies ? copy_s : 0.0);
}

}  // namespace hvp::host
