#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "models/fixed/solver.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/rtl/compared.h"
#include "vp/fpga/rtl/rtl_engine.h"
#include "vp/fpga/rtl/rtl_waveform.h"

namespace hvp::vp::rtl {

// Runs the engine in SystemVerilog through the jobs of the cycle-accurate one and compares both:
// before a job x, b and, unless x is on its way into them, the copies of d; after each iteration
// scalars, exponents and every word of x, r, b, q and all copies of d; once a job the matrix; after
// it the vectors, the report, the clocks of every state and those in which packages have waited.
// The host's accesses have to be made to both, to this one before the other.
// Bits that flip do so in both, and both go on equally wrong.
class RtlComparison : public fixed::Observer {
 public:
  // Throws InputError as RtlEngine does.
  RtlComparison(engine::CycleEngine& engine, const EngineSize& size, int seed = 1)
      : engine_(engine), rtl_(size, engine.architecture(), seed) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
  // To be called before the engine's start_solve().
  void write_b(std::span<const std::int32_t> words);
  // To be called before the engine's write_x(), as x goes into the copies of d from now on.
  void write_x(std::span<const std::int32_t> words);
  // To be called before the engine's start_solve(), which gets this as its observer.
  void start_solve(const fixed::Settings& settings);
  void iteration(const fixed::IterationState& state) override;
  // To be called when the engine's solve is over; then x is on its way into the copies of d.
  void end_solve();
  // To be called behind the engine's start_inversion().
  void invert();
  // To be called behind the engine's start_constraining() and start_restoring().
  void constrain(int node, std::int32_t diagonal);
  void restore(int node, std::span<const std::int32_t> row);
  // To be called with the engine's carry_words().
  void expect_flips();
  // To be called before the engine's flip(), amid two edges.
  void flip(const engine::Flip& flip);
  // To be called before the engine's abort(): the solve has had as many clocks in both.
  void abort();

  // Shows the RTL engine in `path` from now on, as RtlWaveform does, until close_waveform().
  void open_waveform(const std::string& path, const engine::TraceWindow& window);
  void close_waveform();

  RtlEngine& rtl() { return rtl_; }
  // The first difference, with register or word, clock and both values; empty if there is none.
  const std::string& difference() const { return difference_; }
  const Compared& compared() const { return compared_; }
  // The clocks that the last solve has waited for x in the copies of d.
  std::int64_t waited() const { return waited_; }

 private:
  // The edges of the engine's clock since then.
  std::int64_t edges_since(const sc_core::sc_time& time) const;
  std::int64_t period_ps() const;
  // The engine copies x from this instant on.
  void begin_copy(const sc_core::sc_time& from);
  // The copy of x is over, some clocks behind the order.
  void begin_solve();
  // Gives the RTL engine the clocks that the other one has had.
  void catch_up();
  std::int64_t solve_edges() const { return edges_since(solve_from_); }
  void edit(int node, const std::function<std::int64_t()>& edited, const char* what);
  void compare(const std::string& what, std::int64_t rtl, std::int64_t model);
  void compare_words(Vector vector, std::span<const std::int32_t> model);
  void compare_copy(Vector vector, int copy, std::span<const std::int32_t> model);
  void compare_direction();
  // What passes over all nodes have written.
  void compare_vectors();
  void compare_matrix();
  // The host's port.
  void compare_x();
  // Of all partitions of the model, since it was made.
  std::int64_t turn_waits() const;
  std::int64_t room_waits() const;

  engine::CycleEngine& engine_;
  RtlEngine rtl_;
  std::unique_ptr<RtlWaveform> waveform_;  // null: none is asked for
  std::vector<std::int32_t> x_, model_x_;
  std::string difference_;
  Compared compared_;
  std::int64_t started_solves_ = 0;
  bool matrix_is_compared_ = false;  // in this job
  sc_core::sc_time copied_from_, started_, solve_from_;
  std::int64_t waited_ = 0;
  // The clocks that the model's packages had waited before the solve.
  std::int64_t turn_waits_ = 0, room_waits_ = 0;
  bool solving_ = false;
  // The solve is not ordered yet, as it waits for x in the copies of d.
  bool waits_ = false;
  bool expects_flips_ = false;
  fixed::Settings settings_;
  std::vector<std::int32_t> b_;            // to be written when the copy is over
  std::vector<engine::Flip> index_flips_;  // since the matrix was loaded
};

}  // namespace hvp::vp::rtl
