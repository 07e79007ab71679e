#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <systemc>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/phase_clocks.h"
#include "vp/fpga/engine/sequencer.h"

namespace hvp::vp::engine {

// The engine approximately timed: one event a phase of an iteration. A phase begins when what it
// needs is computed and the memories and units it holds are free, and holds them for the clocks
// that their conflicts leave it (PhaseClocks). The words are those of whatever fixed::Solver the
// caller has; its report says how many phases there are.
class PhaseEngine : public sc_core::sc_module {
 public:
  enum class Unit { matrix, direction, vectors, divider, count };

  PhaseEngine(const sc_core::sc_module_name& name, const accel::Architecture& architecture);

  // Throws InputError as CycleEngine::load() does.
  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
  // The host has written x, which then goes into the copies of d, as after every solve.
  void written_x() { copy_x(); }
  // A solve that went as the report says, from when x is in the copies of d. Throws InputError for
  // a method it does not have.
  void start_solve(const fixed::Settings& settings, const fixed::Report& report);
  void abort();

  // When a phase begins, for traces.
  std::function<void(State)> phase_begun;

  const sc_core::sc_event& done() const { return done_; }
  bool idle() const { return state_ == State::idle; }
  // Of the last solve, its wait for x included.
  std::int64_t clocks() const { return clock_; }
  const StateClocks& state_clocks() const { return state_clocks_; }
  const PhaseClocks& phases() const { return phases_; }
  // Clocks of the last solve in which a unit was held.
  std::int64_t held(Unit unit) const { return held_[static_cast<std::size_t>(unit)]; }

 private:
  void advance();
  State next() const;
  void hold(State state, const sc_core::sc_time& after = sc_core::SC_ZERO_TIME);
  void copy_x();
  bool replaces() const;

  accel::Architecture architecture_;
  std::optional<Layout> layout_;
  PhaseClocks phases_;
  fixed::Settings settings_;
  fixed::Report report_;
  sc_core::sc_time period_;
  sc_core::sc_time copied_;  // when x is in the copies of d
  sc_core::sc_event over_;
  sc_core::sc_event done_;

  State state_ = State::idle;
  int loop_ = 0;             // iterations begun
  std::size_t product_ = 0;  // the next one's number in PhaseClocks
  std::int64_t clock_ = 0;
  std::array<std::int64_t, static_cast<std::size_t>(Unit::count)> free_at_{};
  std::array<std::int64_t, static_cast<std::size_t>(Unit::count)> held_{};
  StateClocks state_clocks_{};
};

}  // namespace hvp::vp::engine
