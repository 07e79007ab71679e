#pragma once

#include <optional>
#include <vector>

#include "models/config/declaration.h"
#include "models/host/solve_work.h"
#include "models/random/distribution.h"

namespace hvp::host {

// The scenario's effect [host.gpu.latencies]: what each solve on the GPU takes longer.
struct GpuLatencies : random::TimeDistribution {
  GpuLatencies();
  void declare(config::Visitor& v);
};

// The scenario's effect [host.gpu]: the host's own solve is made by a GPU. The host launches it,
// waits for it, and makes what is not of the solve itself: contact that moves, the set-up. A solve
// takes
//
//   start + waits · wait + copies + vectors / link + bytes / bandwidth + operations / rate
//
// where its workers wait for each other after each part that needs all of the one before
// (SolveWork::barriers), in a kernel of its own or inside one that stays. The bandwidth is the
// cache's where the solve's working set fits there, else the memory's.
struct Gpu {
  // plain: each part is a kernel that the host launches. graph: all kernels are launched at once.
  // persistent: one kernel stays, and finds its load in memory.
  enum class Launch { plain, graph, persistent };
  // copies: load and solution are copied by the driver. unified: the GPU reads and writes the
  // host's memory, or the host the GPU's.
  enum class Memory { copies, unified };

  Launch launch = Launch::graph;
  Memory memory = Memory::copies;
  double plain_start_s = 6.4e-6;
  double plain_kernel_s = 9.8e-6;
  double graph_start_s = 15e-6;
  double graph_kernel_s = 6e-6;
  double persistent_start_s = 2.2e-6;
  double barrier_s = 1.1e-6;
  double copy_s = 6.5e-6;
  double link_bandwidth = 15e9;
  double cache_bytes = 50e6;
  double cache_bandwidth = 9e12;
  double memory_bandwidth = 3.35e12;
  double double_flops = 34e12;
  double single_flops = 67e12;
  std::optional<GpuLatencies> latencies;

  void declare(config::Visitor& v);
  // What the effect needs of a scenario.
  static std::vector<config::Need> needs();

  double seconds(const SolveWork& work, const SolveMemory& moved) const;
  // Of so many bytes that the host sends beside a solve.
  double load_s(double bytes) const;
};

}  // namespace hvp::host
