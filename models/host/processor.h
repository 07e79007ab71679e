#pragma once

#include <array>
#include <string_view>

#include "models/config/declaration.h"
#include "models/host/solve_work.h"

namespace hvp::host {

// How fast a core of the host solves. A solve takes
//
//   call + Σ operations / rate, by kind of work + Σ bytes / bandwidth, by tier of memory
//
// What a solve touches in every frame it finds in the smallest cache that has room for it. A cache
// that is smaller keeps less and less of what is read in turn, and nothing of twice its size: bytes
// are divided among the tiers by these shares. The rates are those
// of operands that are at hand: what waiting for memory adds is the last term. The scenario's table
// [host.processor], which `hvp measure host` writes.
struct Processor {
  struct Tier {
    double size_bytes = 0;
    double bandwidth = 0;  // bytes a second, of one core that reads
  };

  double call_s = 0;  // of every solve, whatever it does
  // Operations a second.
  double dense_flops = 0;
  double single_flops = 0;  // dense, in single precision
  double sparse_flops = 0;
  double triangular_flops = 0;
  std::array<Tier, 3> caches;
  double memory_bandwidth = 0;

  // The defaults are the present values.
  void declare(config::Visitor& v);
  void check() const;

  // Of a solve that touches so many bytes, bytes a second.
  double bandwidth(double working_set) const;
  double seconds(const SolveWork& work, double working_set) const;
};

// Whose figures price the host's own solve. The scenario's key host.model.
enum class ProcessorModel {
  one_rate,      // all work at one rate: host.sustained_rate, host.solver_rate
  thesis_pc,     // a Pentium D at 2.8 GHz (thesis §6.2)
  desktop_2026,  // a core of today
  measured,      // the table [host.processor]
};

const char* name(ProcessorModel model);

// Throws std::logic_error for one_rate and measured, which have no figures of their own.
const Processor& built_in(ProcessorModel model);

}  // namespace hvp::host
