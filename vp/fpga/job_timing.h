#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <systemc>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fidelity.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/engine/engine_trace.h"
#include "vp/fpga/engine_port_sink.h"
#include "vp/fpga/rtl/compared.h"

namespace hvp::vp {

// The clocks of a solve, by state.
struct SolveClocks {
  std::int64_t clocks = 0;  // from the start until done
  engine::StateClocks state{};
};

// The timing of the accelerator's jobs at one level of fidelity. The clocks of a job are returned
// if they are known at its start; otherwise ended() is notified at its end.
class JobTiming {
 public:
  virtual ~JobTiming() = default;

  // Lays the matrix out in the memories. Throws InputError if it does not fit.
  virtual void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) = 0;
  // Takes other values of the matrix that is laid out, and the start of the next solve with x as
  // write_x() says. The clocks of a pattern do not depend on them.
  virtual void renew(const fixed::QuantisedMatrix& /*matrix*/,
                     const fixed::Settings& /*settings*/) {}
  // Starts the job that ends a load, or an update of all values.
  virtual std::optional<std::int64_t> start_load(const fixed::Settings& settings) = 0;
  // Starts a solve with the report's work.
  virtual std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                                  const fixed::Report& report) = 0;
  // The clocks for which the access that changes a node's row and column is stalled: to a contact
  // node's, or back to `row`. `matrix` has them already.
  virtual std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                                   const fixed::Settings& settings,
                                   std::span<const std::int32_t> row) = 0;
  // Aborts the job.
  virtual void abort() {}

  // Null if all clocks are known at the start.
  virtual const sc_core::sc_event* ended() const { return nullptr; }
  // The last solve's clocks, if an engine took them.
  virtual std::optional<SolveClocks> solve_clocks() const { return std::nullopt; }

  // True if it computes words itself. It is then given b and x, and confirms the solution.
  virtual bool has_words() const { return false; }
  virtual void write_b(std::span<const std::int32_t> /*words*/) {}
  // The host has written x, the solution's memory. The words are empty if none are computed here.
  virtual void write_x(std::span<const std::int32_t> /*words*/) {}
  // True if these are the words that the last solve has put out.
  virtual bool confirms(std::span<const std::int32_t> /*solution*/) { return true; }
  // The next extrapolated start has no solution before x.
  virtual void forget_previous() {}

  // Other levels than rtl have no such port.
  virtual void record_port(const EnginePortSink& /*record*/) {}

  // For a level with memories and registers. From now on their bits may flip; to be called while no
  // job runs.
  virtual void carry_words() {}
  // Flips a bit, amid two edges.
  virtual void flip(const engine::Flip& /*flip*/) {}
  // The words of x as they are now, and the last solve's report as an engine knows it.
  virtual void read_x(std::span<std::int32_t> /*words*/) const {}
  virtual fixed::Report report() { return {}; }

  // The cycle-accurate engine; null at other levels.
  virtual const engine::CycleEngine* engine() const { return nullptr; }
  // What the level rtl has compared so far; empty at other levels.
  virtual std::optional<rtl::Compared> compared() const { return std::nullopt; }
  // Where the engines of the level rtl part, which ends the run; empty: nowhere so far.
  virtual std::string difference() const { return {}; }
  // A waveform of the RTL engine, in GTKWave's format FST, until it is closed; false at other
  // levels.
  virtual bool open_rtl_waveform(const std::string& /*path*/,
                                 const engine::TraceWindow& /*window*/) {
    return false;
  }
  virtual void close_rtl_waveform() {}
};

// Makes the timing of this level. A module becomes a child of the module under construction. Throws
// InputError with a key of accel::Architecture if an engine cannot have this architecture.
std::unique_ptr<JobTiming> make_job_timing(Timing level, const accel::Architecture& architecture);

}  // namespace hvp::vp
