#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/host/frame_method.h"
#include "models/host/gpu.h"
#include "models/host/passivity.h"
#include "models/host/processor.h"
#include "models/host/shared_core.h"
#include "models/host/virtual_coupling.h"
#include "models/random/distribution.h"

namespace hvp::host {

// When the driver makes an optional check.
enum class Guard { with_faults, always, never };

// The host's reaction to a board that fails. The scenario's table [host.recovery].
struct Recovery {
  Guard bus_errors = Guard::with_faults;
  Guard hold_saturated = Guard::with_faults;
  int retries = 1;
  int attempts = 8;
  int back_off_frames = 1;

  void declare(config::Visitor& v);

  // The number of frames between the n-th failed set-up in a row and the next one.
  int back_off(int failed) const;
};

inline bool guards(Guard guard, bool faults) {
  return guard == Guard::always || (guard == Guard::with_faults && faults);
}

// The 33 Hz process: collision detection and drawing (thesis §6.2.3). Table [host.graphics].
struct Graphics {
  double rate_hz = 33;
  double drawing_s = 10e-3;
  double triangle_s = 0;  // additional time for each triangle of the surface
  // With one core: the first non_preemptible_s of every non_preemptible_every_s of its processor
  // time cannot be preempted.
  double non_preemptible_s = 0;
  double non_preemptible_every_s = 1e-3;

  // `cores` is the number of the host's cores.
  void declare(config::Visitor& v, int cores);
  void check() const;

  std::int64_t period_ps() const;
  // The drawing time for a surface of so many triangles.
  std::int64_t drawing_ps(std::size_t triangles) const;
};

// The scenario's effect [host.interrupt_latencies]: Host::interrupt_latency_s drawn for each
// interrupt.
struct InterruptLatencies : random::TimeDistribution {
  InterruptLatencies();
  void declare(config::Visitor& v);
};

// The scenario's effect [host.delay]: every force reaches the motor later by this time, whatever
// the host does meanwhile. The forces wait behind the output's converter, in order, for any number
// of periods.
struct Delay {
  double time_s = 1e-3;

  void declare(config::Visitor& v);
};

// The scenario's effect [host.threads]: the host's own solver works with several threads, each on a
// core of its own. Its time is that of one over `speedup`, and `barrier_s` each time they wait for
// each other.
struct Threads {
  int count = 2;
  double speedup = 1;
  double barrier_s = 0.25e-6;
  int cores = 4;  // of the machine

  void declare(config::Visitor& v);
  // Throws InputError where threads are more than cores, or faster than as many cores are.
  void check() const;
  // The time of work that takes one thread so long, s.
  double seconds(double one_thread_s, const SolveWork& work) const;
};

// The host PC in numbers: the cost of each step of Fig. 6.2. The scenario's table [host].
//
// A step's cost is its floating-point operations over the rate at which the processor sustains
// sparse products, so that it grows with the mesh as the step does, plus a part that does not
// depend on the mesh. The two processes have a core each (the thesis' Pentium D has two) or share
// one.
struct Host {
  double sustained_rate_flops = 297.88e6;
  double contact_lookup_s = 1e-6;
  double driver_call_s = 1e-6;
  double driver_word_s = 0;
  double interrupt_latency_s = 5e-6;
  double timeout_s = 10e-3;
  SolvedBy solver = SolvedBy::board;
  Precision precision = Precision::double_precision;
  ProcessorModel model = ProcessorModel::one_rate;
  Processor processor = built_in(ProcessorModel::desktop_2026);  // of a model that is measured
  double solver_rate_flops = 0;  // of one_rate; 0: sustained_rate_flops
  std::optional<Gpu> gpu;
  std::optional<Threads> threads;
  int substeps = 0;  // of explicit time steps, a frame; 0: as many as are stable
  int pipeline_depth = 0;
  double quantum_s = 0;  // the most by which the servo process' time runs ahead in the simulation
  int cores = 2;
  double context_switch_s = 3.8e-6;
  std::optional<random::TimeDistribution> jitter;
  std::optional<random::TimeDistribution> wake_up;
  std::optional<InterruptLatencies> interrupt_latencies;
  std::optional<Delay> delay;
  std::optional<VirtualCoupling> virtual_coupling;
  std::optional<Passivity> passivity;
  Graphics graphics;
  Recovery recovery;

  // `body` is the condition that there is a body and not a wall.
  void declare(config::Visitor& v,
               const config::Condition& body = config::not_beside("wall", false, {}));
  void check() const;

  // The settings of a core that the processes share (shared_core.h).
  SharedCore::Settings shared_core() const;
  // The driver's own time, without its bus accesses, in a call that packs or unpacks so many vector
  // words.
  double driver_s(std::size_t words) const;
  // Operations a second of the host's steps beside its own solve.
  double rate_flops() const;
  // The time of so many additions and multiplications beside a solve, in whole picoseconds.
  std::int64_t compute_ps(double operations) const;
  // The time of the host's own solve, in s: on the GPU where there is one, else on a core.
  double solve_s(const SolveWork& work, const SolveMemory& memory) const;
  // On a core in any case: the set-up, contact that moves, what is solved for after the force.
  double core_solve_s(const SolveWork& work, double working_set) const;
  // Null where one rate prices all.
  const Processor* prices() const;
};

// The operations of converting `words` numbers from double precision to the board's words, or back:
// scale, round, and two comparisons to clamp.
double conversion_operations(int words);

// The scenario's effect [guest]: how a host that is another program takes its time. Without it a
// kernel's instructions take no time, and its interrupts arrive at their exact time. With it, an
// interrupt of `hvp linux` takes Host::interrupt_latency_s, or a time that
// [host.interrupt_latencies] draws.
struct GuestCosts {
  // A longer wait of the kernel counts as a sleep of its programs (app/linux/guest.cpp).
  static constexpr double kLongestSystemCall = 9e-6;

  enum class Schedule { immediate, random };
  enum class MemoryOrder { strong, weak };

  double system_call_s = 0.17e-6;  // before each call does anything
  Schedule schedule = Schedule::immediate;
  double longest_delay_s = 1e-3;  // of a random schedule
  MemoryOrder memory_order = MemoryOrder::strong;

  void declare(config::Visitor& v);
};

}  // namespace hvp::host
