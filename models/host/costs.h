#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/host/host_solve.h"
#include "models/host/recovery.h"
#include "models/host/shared_core.h"
#include "models/random/distribution.h"

namespace hvp::host {

// The 33 Hz process: collision detection and drawing (thesis §6.2.3). Table [host.graphics].
struct Graphics {
  double rate_hz = 33;
  double drawing_s = 10e-3;
  double triangle_s = 0;  // more of it for each triangle of the surface
  // On one core: the first so much of every so much of its processor time cannot be preempted.
  double non_preemptible_s = 0;
  double non_preemptible_every_s = 1e-3;

  // `cores` of the host that draws.
  void declare(config::Visitor& v, int cores);
  void check() const;

  std::int64_t period_ps() const;
  // Of a picture of a surface of so many triangles.
  std::int64_t drawing_ps(std::size_t triangles) const;
};

// The scenario's effect [host.interrupt_latencies]: Host::interrupt_latency_s drawn for each
// interrupt.
struct InterruptLatencies : random::TimeDistribution {
  InterruptLatencies();
  void declare(config::Visitor& v);
};

// The scenario's effect [host.delay]: every force is at the motor so much later, whatever the host
// does meanwhile: it is held back behind the output's converter, in order, however many periods
// that is.
struct Delay {
  double time_s = 1e-3;

  void declare(config::Visitor& v);
};

// The host PC as arithmetic: what each step of Fig. 6.2 costs. The scenario's table [host].
//
// A step's cost is its floating-point operations over the rate at which the processor sustains
// sparse products, so that it grows with the mesh as the step does, plus what does not depend on
// the mesh. The two processes run on a core each (the thesis' Pentium D has two), or share one.
struct Host {
  double sustained_rate_flops = 297.88e6;
  double contact_lookup_s = 1e-6;
  double driver_call_s = 1e-6;
  double driver_word_s = 0;
  double interrupt_latency_s = 5e-6;
  double timeout_s = 10e-3;
  SolvedBy solver = SolvedBy::board;
  double solver_rate_flops = 0;  // 0: sustained_rate_flops
  int pipeline_depth = 0;
  double quantum_s = 0;  // how far the servo process' time may run ahead in the simulation
  int cores = 2;
  double context_switch_s = 3.8e-6;
  std::optional<random::TimeDistribution> jitter;
  std::optional<random::TimeDistribution> wake_up;
  std::optional<InterruptLatencies> interrupt_latencies;
  std::optional<Delay> delay;
  Graphics graphics;
  Recovery recovery;

  // `body`: where there is one, and not a wall.
  void declare(config::Visitor& v,
               const config::Condition& body = config::not_beside("wall", false, {}));
  void check() const;

  // Where the processes share one core: shared_core.h.
  SharedCore::Settings shared_core() const;
  // Of the driver beside its bus accesses, in a call that packs or unpacks so many vector words.
  double driver_s(std::size_t words) const;
  // The rate of the host's own solve over that of its other steps.
  double solver_speed() const;
  // Time of so many additions and multiplications, in whole picoseconds.
  std::int64_t compute_ps(double operations) const;
};

// Operations to turn `words` numbers from double precision into the board's words, or back:
// scale, round, and two comparisons to clamp.
double conversion_operations(int words);

}  // namespace hvp::host
