#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <systemc>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fidelity.h"
#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp {

// Where the clocks of a solve went.
struct SolveClocks {
  std::int64_t clocks = 0;  // from the start until done
  engine::StateClocks state{};
};

// How long the accelerator's jobs take, at one level of fidelity. Clocks that are known when a job
// starts are returned; else the job is over when ended() is notified.
class JobTiming {
 public:
  virtual ~JobTiming() = default;

  // How the matrix lies in the memories. Throws InputError where it does not fit.
  virtual void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) = 0;
  // The command that ends a load; a job.
  virtual std::optional<std::int64_t> start_load(fixed::Method method) = 0;
  // A solve that goes as the report says; a job.
  virtual std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                                  const fixed::Report& report) = 0;
  // Clocks for which the access is held that changes a node's row and column: to a contact's, or
  // back to `row`. The matrix has them already.
  virtual std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                                   fixed::Method method, std::span<const std::int32_t> row) = 0;
  // The job is given up.
  virtual void abort() {}

  // Null where all clocks are known at the start.
  virtual const sc_core::sc_event* ended() const { return nullptr; }
  // Of the last solve, where an engine took them.
  virtual std::optional<SolveClocks> solve_clocks() const { return std::nullopt; }

  // Whether it computes words itself: it is then given b and x, and confirms the solution.
  virtual bool has_words() const { return false; }
  virtual void write_b(std::span<const std::int32_t> /*words*/) {}
  // The host has written x, the solution's memory; without words where there are none here.
  virtual void write_x(std::span<const std::int32_t> /*words*/) {}
  // Whether these are the words that the last solve has put out.
  virtual bool confirms(std::span<const std::int32_t> /*solution*/) { return true; }
  // The next extrapolated start has no solution before x.
  virtual void forget_previous() {}

  // Cycle-accurate; null elsewhere.
  virtual const engine::CycleEngine* engine() const { return nullptr; }
};

// The one of this level. What is a module becomes a child of the module that is being constructed.
// Throws InputError with a key of accel::Architecture where an engine cannot be built so.
std::unique_ptr<JobTiming> make_job_timing(Timing level, const accel::Architecture& architecture);

}  // namespace hvp::vp
