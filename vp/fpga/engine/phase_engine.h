#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/sequencer.h"

namespace hvp::vp::engine {

// The clocks of successive products from a reset on. Each product leaves behind whose rows are
// first in turn, so that one can take longer than the next; after the last entry they repeat.
struct ProductClocks {
  std::vector<std::int64_t> clocks;
  std::size_t repeats_from = 0;

  std::size_t after(std::size_t product) const {
    return product + 1 < clocks.size() ? product + 1 : repeats_from;
  }
};

// The clocks for which a pass occupies its memories and units, including its pipelines. They follow
// from reservations: a package occupies the banks of d as long as its own columns make them
// compete, a finished row occupies a lane of the vector unit and a bank of q, a group of nodes
// occupies the ports of d when it is read and when it is written. They do not depend on words, so
// that they are found once for a matrix and serve all its solves.
struct PhaseClocks {
  ProductClocks products;
  std::int64_t vectors = 0;            // a pass without d
  std::int64_t writing_direction = 0;  // d is written
  std::int64_t reading_direction = 0;  // d is read: group b
  std::int64_t moving_direction = 0;   // both: group c, and a pass that exchanges x and d

  std::int64_t bank_stalls = 0;  // clocks of one product that partitions waited for banks of d
};
PhaseClocks phase_clocks(const accel::Architecture& architecture, const Layout& layout);

// The engine approximately timed, with one event for each phase of an iteration. A phase begins
// when its inputs are computed and its memories and units are free, and occupies them for the
// clocks that follow from their conflicts (PhaseClocks). The words are those of the caller's
// fixed::Solver, whose report gives the number of phases.
class PhaseEngine : public sc_core::sc_module {
 public:
  enum class Unit { matrix, direction, vectors, divider, count };

  PhaseEngine(const sc_core::sc_module_name& name, const accel::Architecture& architecture);

  // Throws InputError as CycleEngine::load() does.
  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
  // The host has written x, which is then copied into the copies of d, as after every solve.
  void written_x() { copy_x(); }
  // Starts a solve with the report's phases as soon as x is in the copies of d. Throws InputError
  // for an unsupported method.
  void start_solve(const fixed::Settings& settings, const fixed::Report& report);
  void abort();

  // Called when a phase begins, for traces.
  std::function<void(State)> phase_begun;

  const sc_core::sc_event& done() const { return done_; }
  bool idle() const { return state_ == State::idle; }
  // The clocks of the last solve, including its wait for x.
  std::int64_t clocks() const { return clock_; }
  const StateClocks& state_clocks() const { return state_clocks_; }
  const PhaseClocks& phases() const { return phases_; }
  // The clocks of the last solve in which a unit was occupied.
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
  int loop_ = 0;             // iterations that have begun
  std::size_t product_ = 0;  // the next one's number in PhaseClocks
  std::int64_t clock_ = 0;
  std::array<std::int64_t, static_cast<std::size_t>(Unit::count)> free_at_{};
  std::array<std::int64_t, static_cast<std::size_t>(Unit::count)> held_{};
  StateClocks state_clocks_{};
};

}  // namespace hvp::vp::engine
