#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "models/fixed/solver.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl {

// Runs the engine in SystemVerilog through the jobs of the cycle-accurate one and compares both:
// after each iteration the scalars and exponents, which depend on every word of r, d and A·d; after
// each job x, the report and the clocks of every state. The host's accesses have to be made to
// both, to this one before the other.
class RtlComparison : public fixed::Observer {
 public:
  // Throws InputError as RtlEngine does.
  RtlComparison(engine::CycleEngine& engine, const EngineSize& size, int seed = 1)
      : engine_(engine), rtl_(size, engine.architecture(), seed) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
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
  // To be called before the engine's abort(): the solve has had as many clocks in both.
  void abort();

  RtlEngine& rtl() { return rtl_; }
  // The first difference, with register or word, clock and both values; empty if there is none.
  const std::string& difference() const { return difference_; }
  std::int64_t compared_clocks() const { return compared_clocks_; }
  // The clocks that the last solve has waited for x in the copies of d.
  std::int64_t waited() const { return waited_; }

 private:
  // The edges of the engine's clock since then.
  std::int64_t edges_since(const sc_core::sc_time& time) const;
  void compare(const std::string& what, std::int64_t rtl, std::int64_t model);
  void compare_x();

  engine::CycleEngine& engine_;
  RtlEngine rtl_;
  std::vector<std::int32_t> x_, model_x_;
  std::string difference_;
  std::int64_t compared_clocks_ = 0;
  sc_core::sc_time copied_from_, started_;
  std::int64_t waited_ = 0;
  bool solving_ = false;
};

}  // namespace hvp::vp::rtl
